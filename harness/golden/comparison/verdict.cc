#include "harness/golden/comparison/verdict.h"

namespace touchstone::golden {

std::string_view to_string(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::equal:
      return "equal";
    case Verdict::better:
      return "better";
    case Verdict::worse:
      return "worse";
    case Verdict::missing:
      return "missing";
    case Verdict::invalid:
      return "invalid";
  }
  return "invalid";
}

}  // namespace touchstone::golden
