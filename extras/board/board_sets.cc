#include "board_sets.h"

#include "harness/pipeline/evaluation/campaign.h"
#include "write_dataset.h"

namespace touchstone::board {

std::vector<std::filesystem::path> board_sets(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out = pipeline::bundled_datasets();
  for (const datasets::Recipe& recipe : datasets::families()) {
    out.push_back(folder / recipe.name);
    if (!std::filesystem::exists(out.back() / "dataset.json")) datasets::write_dataset(recipe, 1, out.back());
  }
  return out;
}

}  // namespace touchstone::board
