// The diagnosis as text and as JSON.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "harness/surface/mesh_doctor.h"

namespace touchstone::surface {
namespace {

std::string list(const std::vector<std::int32_t>& indices) {
  // The fan of a hub may be long.
  constexpr std::size_t most = 8;
  std::string out;
  for (std::size_t i = 0; i < indices.size() && i < most; ++i)
    out += fmt::format("{}{}", i > 0 ? ", " : "", indices[i]);
  return indices.size() > most ? out + fmt::format(", ... ({} in all)", indices.size()) : out;
}

}  // namespace

std::string diagnosis_text(const MeshDiagnosis& d, const std::string& source) {
  const Vec3 size = d.bounds.sizes();
  std::string out = fmt::format("{}: {} triangles, {} vertices, {} {}, {:.6g} x {:.6g} x {:.6g} m, area {:.6g} m^2",
                                source, d.triangles, d.vertices, d.components, d.components == 1 ? "piece" : "pieces",
                                size.x(), size.y(), size.z(), d.area_m2);
  out += d.open_edges == 0 ? fmt::format(", volume {:.6g} m^3\n", d.volume_m3) : "\n";
  for (const MeshFinding& finding : d.findings) {
    out += fmt::format("\n[{}] {}: {}.\n  {}\n", finding.severity == Severity::matters ? "matters" : "note",
                       finding.name, finding.what, finding.meaning);
    for (const MeshPlace& place : finding.places) {
      out += fmt::format("  at ({:.6g}, {:.6g}, {:.6g}) m", place.p_W_m.x(), place.p_W_m.y(), place.p_W_m.z());
      if (!place.triangles.empty())
        out += fmt::format(", {} {}", place.triangles.size() == 1 ? "triangle" : "triangles", list(place.triangles));
      if (!place.vertices.empty())
        out += fmt::format(", {} {}", place.vertices.size() == 1 ? "vertex" : "vertices", list(place.vertices));
      out += "\n";
    }
    if (finding.count > finding.places.size())
      out += fmt::format("  and {} more\n", finding.count - finding.places.size());
  }
  if (!d.self_intersection_checked) out += "\nSelf-intersection was not checked: this build has no CGAL.\n";
  out += d.sound() ? "\nNothing that matters to rendering was found.\n"
                   : "\nFindings that matter to rendering: see above.\n";
  return out;
}

std::string diagnosis_json(const MeshDiagnosis& d, const std::string& source) {
  using Json = nlohmann::ordered_json;
  const auto vec = [](const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); };
  Json findings = Json::array();
  for (const MeshFinding& finding : d.findings) {
    Json places = Json::array();
    for (const MeshPlace& place : finding.places)
      places.push_back({{"triangles", place.triangles}, {"vertices", place.vertices}, {"p_m", vec(place.p_W_m)}});
    findings.push_back({{"name", finding.name},
                        {"severity", finding.severity == Severity::matters ? "matters" : "note"},
                        {"count", finding.count},
                        {"what", finding.what},
                        {"meaning", finding.meaning},
                        {"places", std::move(places)}});
  }
  const Json json{{"schema", "touchstone-mesh-diagnosis/1"},
                  {"mesh", source},
                  {"sound", d.sound()},
                  {"triangles", d.triangles},
                  {"vertices", d.vertices},
                  {"components", d.components},
                  {"open_edges", d.open_edges},
                  {"boundary_loops", d.boundary_loops},
                  {"bounds_m", {vec(d.bounds.min()), vec(d.bounds.max())}},
                  {"area_m2", d.area_m2},
                  {"volume_m3", d.volume_m3},
                  {"self_intersection_checked", d.self_intersection_checked},
                  {"findings", std::move(findings)}};
  // A file name need not be UTF-8.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace touchstone::surface
