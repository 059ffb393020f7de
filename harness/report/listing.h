// What a program knows, by kind (renderers, effects, metrics, ...), as text and as JSON.
#pragma once

#include <string>
#include <vector>

namespace touchstone::report {

struct ListedParameter {
  std::string name, unit, meaning;
  double initial = 0.0;
};

struct ListedItem {
  std::string name, summary;
  std::vector<ListedParameter> parameters;
};

struct ListedKind {
  std::string name, title;  // "effects", and what it is called above its items
  std::vector<ListedItem> items;
};

// The title, an item a line, its parameters below it, and an empty line.
std::string listing_text(const ListedKind& kind);
// {"schema": "touchstone-list/1", KIND: [{"name", "summary", "parameters": [{"name", "unit", "default", "meaning"}]}]}
std::string listing_json(const std::vector<ListedKind>& kinds);

}  // namespace touchstone::report
