// A JSON document that is valid but for what the choices change in it: values of another type or size, members that are
// gone, twice there under another name, or taken from elsewhere in the document.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "harness/testing/choices.h"

namespace touchstone::testing {

// Somewhere in the tree; the root itself is rare.
inline nlohmann::json* somewhere(nlohmann::json& root, Choices& choices) {
  nlohmann::json* node = &root;
  while (node->is_structured() && !node->empty() && !choices.one_in(6)) {
    auto child = node->begin();
    std::advance(child, static_cast<std::ptrdiff_t>(choices.below(node->size())));
    node = &*child;
  }
  return node;
}

inline nlohmann::json strange_value(Choices& choices, nlohmann::json& root) {
  switch (choices.below(9)) {
    case 0:
      return nullptr;
    case 1:
      return choices.number();
    case 2:
      return choices.whole();
    case 3:
      return -static_cast<std::int64_t>(choices.below(65536));
    case 4:
      return choices.text({"", "x", "../..", "/dev/zero", "NaN", "1e999", "\x01", "\xc3\xa9", "-"});
    case 5:
      return nlohmann::json::array();
    case 6:
      return nlohmann::json::object();
    case 7:
      return choices.below(2) == 0;
    default:
      return *somewhere(root, choices);
  }
}

inline nlohmann::json damaged_json(nlohmann::json root, Choices& choices) {
  while (!choices.over()) {
    nlohmann::json* const node = somewhere(root, choices);
    nlohmann::json value = strange_value(choices, root);
    if (value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace).size() > 4096) break;
    if (node->is_object() && !node->empty() && choices.one_in(3)) {
      auto member = node->begin();
      std::advance(member, static_cast<std::ptrdiff_t>(choices.below(node->size())));
      if (choices.below(2) == 0) {
        node->erase(member);
      } else {
        (*node)[member.key() + choices.text({"_", "s", ""})] = std::move(value);
      }
    } else if (node->is_array() && choices.one_in(3)) {
      if (node->empty() || choices.below(2) == 0) {
        node->push_back(std::move(value));
      } else {
        node->erase(choices.below(node->size()));
      }
    } else {
      *node = std::move(value);
    }
  }
  return root;
}

inline std::string as_text(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace touchstone::testing
