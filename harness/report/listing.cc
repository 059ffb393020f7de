#include "harness/report/listing.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace touchstone::report {

std::string listing_text(const ListedKind& kind) {
  std::string text;
  text += kind.title + "\n";
  std::size_t width = 0;
  for (const ListedItem& item : kind.items) width = std::max(width, item.name.size());
  for (const ListedItem& item : kind.items) {
    text += fmt::format("  {:{}}  {}\n", item.name, width, item.summary);
    for (const ListedParameter& p : item.parameters) {
      text +=
          fmt::format("  {:{}}    {} [{}], {:g} where not set: {}\n", "", width, p.name, p.unit, p.initial, p.meaning);
    }
  }
  return text + "\n";
}

std::string listing_json(const std::vector<ListedKind>& kinds) {
  nlohmann::ordered_json root;
  root["schema"] = "touchstone-list/1";
  for (const ListedKind& kind : kinds) {
    auto& items = root[kind.name] = nlohmann::ordered_json::array();
    for (const ListedItem& item : kind.items) {
      nlohmann::ordered_json entry{{"name", item.name}, {"summary", item.summary}};
      for (const ListedParameter& p : item.parameters) {
        entry["parameters"].push_back(
            {{"name", p.name}, {"unit", p.unit}, {"default", p.initial}, {"meaning", p.meaning}});
      }
      items.push_back(std::move(entry));
    }
  }
  return root.dump(2) + "\n";
}

}  // namespace touchstone::report
