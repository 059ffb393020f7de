#include "renderers/proxy/proxy_parameters.h"

#include <iterator>
#include <limits>

namespace touchstone::renderers {
using rendering::ParameterDeclaration;

std::vector<ParameterDeclaration> proxy_parameters(std::vector<ParameterDeclaration> more) {
  std::vector<ParameterDeclaration> declared{
      {"stiffness_N_per_m", "N/m", std::numeric_limits<double>::min(), 1e9, 500.0, "spring from tip to god-object"},
      {"tip_radius_m", "m", 0.0, 1e3, 0.0, "0: a point; else a ball whose centre the positions are"}};
  declared.insert(declared.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  return declared;
}

}  // namespace touchstone::renderers
