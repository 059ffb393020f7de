#include "ci/testing/graphql_answer.h"

#include <cctype>
#include <stdexcept>

namespace touchstone::testing {
namespace {

using nlohmann::json;

class GraphqlParser {
 public:
  GraphqlParser(const std::string& text, const json& variables) : text_(text), variables_(variables) {}

  GraphqlRequest run() {
    GraphqlRequest request;
    if (peek() != '{') {
      request.mutation = name() == "mutation";
      if (peek() != '{' && peek() != '(') name();
      if (peek() == '(') {
        while (text_[at_] != ')') ++at_;
        ++at_;
      }
    }
    request.fields = selection();
    return request;
  }

 private:
  char peek() {
    while (at_ < text_.size() && (std::isspace(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == ','))
      ++at_;
    if (at_ >= text_.size()) throw std::invalid_argument("Syntax Error: Unexpected <EOF>");
    return text_[at_];
  }
  void expect(char c) {
    if (peek() != c) throw std::invalid_argument(std::string("Syntax Error: Expected ") + c + ", found " + text_[at_]);
    ++at_;
  }
  std::string name() {
    peek();
    const auto begin = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '_'))
      ++at_;
    if (begin == at_) throw std::invalid_argument(std::string("Syntax Error: Expected Name, found ") + text_[at_]);
    return text_.substr(begin, at_ - begin);
  }
  json object(char end) {
    json value = json::object();
    for (++at_; peek() != end;) {
      const std::string key = name();
      expect(':');
      value[key] = this->value();
    }
    ++at_;
    return value;
  }
  json value() {
    const char c = peek();
    if (c == '{') return object('}');
    if (c == '[') {
      json list = json::array();
      for (++at_; peek() != ']';) list.push_back(value());
      ++at_;
      return list;
    }
    if (c == '$') {
      ++at_;
      return variables_.value(name(), json());
    }
    const auto begin = at_;
    if (c == '"') {
      for (++at_; text_.at(at_) != '"'; ++at_) at_ += text_[at_] == '\\' ? 1 : 0;
      ++at_;
      return json::parse(text_.substr(begin, at_ - begin));
    }
    while (std::string_view(" ,)}]\n\t").find(text_.at(at_)) == std::string_view::npos) ++at_;
    const std::string word = text_.substr(begin, at_ - begin);
    const json parsed = json::parse(word, nullptr, false);
    return parsed.is_discarded() ? json(word) : parsed;  // an enumeration's value is a bare word
  }
  std::vector<GraphqlField> selection() {
    std::vector<GraphqlField> fields;
    expect('{');
    while (peek() != '}') {
      GraphqlField field{name(), json::object(), {}};
      if (at_ < text_.size() && peek() == '(') field.arguments = object(')');
      if (at_ < text_.size() && peek() == '{') field.fields = selection();
      fields.push_back(std::move(field));
    }
    ++at_;
    return fields;
  }

  const std::string& text_;
  const json& variables_;
  std::size_t at_ = 0;
};

bool passes(const json& item, const json& filter) {
  for (const auto& [kind, wanted] : filter.items()) {
    if (kind == "eq") {
      for (const auto& [field, value] : wanted.items()) {
        if (!item.contains(field))
          throw std::invalid_argument("Field \"" + field + "\" is not defined by the filter type.");
        if (item[field] != value) return false;
      }
    } else if (kind == "all") {
      for (const auto& one : wanted) {
        if (!passes(item, one)) return false;
      }
    } else if (kind == "any") {
      bool some = false;
      for (const auto& one : wanted) some = some || passes(item, one);
      if (!some) return false;
    } else {
      throw std::invalid_argument("Field \"" + kind + "\" is not defined by the filter type.");
    }
  }
  return true;
}

json filtered(const json& items, const GraphqlField& field) {
  json kept = json::array();
  for (const auto& item : items) {
    if (!field.arguments.contains("filters") || passes(item, field.arguments["filters"])) kept.push_back(item);
  }
  return kept;
}

json selected(const json& object, const std::vector<GraphqlField>& fields) {
  json value = json::object();
  for (const auto& wanted : fields) {
    if (!object.contains(wanted.name)) throw std::invalid_argument("Cannot query field \"" + wanted.name + "\".");
    value[wanted.name] = graphql_value(object[wanted.name], wanted);
  }
  return value;
}

json connection(const json& items, const GraphqlField& field) {
  const json kept = filtered(items, field);
  const auto first = field.arguments.value("first", std::size_t{100});
  const auto cursor = [](std::size_t i) { return "cursor-" + std::to_string(i); };
  std::size_t begin = 0;
  if (field.arguments.contains("after") && field.arguments["after"].is_string())
    begin = std::stoul(field.arguments["after"].get<std::string>().substr(7));
  const std::size_t end = std::min(begin + first, kept.size());
  json value = json::object();
  for (const auto& wanted : field.fields) {
    if (wanted.name == "edges") {
      json edges = json::array();
      for (std::size_t i = begin; i < end; ++i)
        edges.push_back(selected({{"node", kept[i]}, {"cursor", cursor(i + 1)}}, wanted.fields));
      value["edges"] = edges;
    } else {
      const json page{{"hasNextPage", end < kept.size()},
                      {"endCursor", cursor(end)},
                      {"total", kept.size()},
                      {"count", end - begin}};
      value[wanted.name] = graphql_value(json{{"pageInfo", page}}.at(wanted.name), wanted);
    }
  }
  return value;
}

}  // namespace

GraphqlRequest parse_graphql(const std::string& query, const json& variables) {
  return GraphqlParser(query, variables).run();
}

json graphql_value(const json& model, const GraphqlField& field) {
  if (model.is_object() && model.contains("connection")) return connection(model["connection"], field);
  if (model.is_array()) {
    json list = json::array();
    for (const auto& item : filtered(model, field))
      list.push_back(field.fields.empty() ? item : selected(item, field.fields));
    return list;
  }
  return model.is_object() ? selected(model, field.fields) : model;
}

}  // namespace touchstone::testing
