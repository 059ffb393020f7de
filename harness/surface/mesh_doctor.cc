#include "harness/surface/mesh_doctor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_pieces.h"
#include "harness/surface/mesh_topology.h"

namespace touchstone::surface {
namespace {

class Examination {
 public:
  Examination(const TriangleMesh& mesh, const MeshDoctorRule& rule)
      : raw_(mesh),
        rule_(rule),
        mesh_(weld_coincident_vertices(mesh)),
        topology_(make_topology(mesh_)),
        pieces_(find_pieces(mesh_, topology_)) {}

  MeshDiagnosis run(const SelfIntersectionCheck& check) {
    result_.triangles = mesh_.triangles.size();
    result_.vertices = raw_.vertices_W_m.size();
    result_.components = pieces_.count();
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      result_.area_m2 += 0.5 * mesh_.scaled_normal(t).norm();
      for (const std::int32_t v : mesh_.triangles[t]) result_.bounds.extend(mesh_.vertices_W_m[at(v)]);
    }
    result_.volume_m3 = std::accumulate(pieces_.volume_m3.begin(), pieces_.volume_m3.end(), 0.0);
    open_edges();
    orientation();
    inward_facing();
    degenerate_triangles();
    duplicate_triangles();
    vertices();
    non_manifold();
    folds();
    intersections(check);
    components();
    reading_notes();
    return std::move(result_);
  }

 private:
  MeshFinding& add(std::string name, Severity severity, std::size_t count, std::string what, std::string meaning) {
    return result_.findings.emplace_back(
        MeshFinding{std::move(name), severity, count, std::move(what), std::move(meaning), {}});
  }
  void place(MeshFinding& finding, std::vector<std::int32_t> triangles, std::vector<std::int32_t> vertices,
             const Vec3& p) const {
    if (finding.places.size() < rule_.largest_listed)
      finding.places.push_back({std::move(triangles), std::move(vertices), p});
  }
  void place_edge(MeshFinding& finding, const std::array<std::int32_t, 2>& edge) const {
    std::vector<std::int32_t> owners;
    for (const std::int32_t t : topology_.fan(at(edge[0]))) {
      const auto& c = mesh_.triangles[at(t)];
      if (std::find(c.begin(), c.end(), edge[1]) != c.end()) owners.push_back(t);
    }
    const Vec3 middle = 0.5 * (mesh_.vertices_W_m[at(edge[0])] + mesh_.vertices_W_m[at(edge[1])]);
    place(finding, std::move(owners), {raw_index(edge[0]), raw_index(edge[1])}, middle);
  }
  [[nodiscard]] Vec3 middle(std::int32_t triangle) const {
    const auto& c = mesh_.triangles[at(triangle)];
    return (mesh_.vertices_W_m[at(c[0])] + mesh_.vertices_W_m[at(c[1])] + mesh_.vertices_W_m[at(c[2])]) / 3.0;
  }
  // Joining renames vertices: back to the file's number, by way of a triangle that has it.
  [[nodiscard]] std::int32_t raw_index(std::int32_t vertex) const {
    const auto fan = topology_.fan(at(vertex));
    if (fan.empty()) return vertex;
    const auto& welded = mesh_.triangles[at(fan.front())];
    const auto corner = std::find(welded.begin(), welded.end(), vertex) - welded.begin();
    return raw_.triangles[at(fan.front())][static_cast<std::size_t>(corner)];
  }

  void reading_notes() {
    for (const MeshReadingNote& note : raw_.notes) {
      const bool folded = note.name == "folded-polygons";
      MeshFinding& finding =
          add(note.name, folded ? Severity::matters : Severity::note, note.count, note.what,
              folded ? "A turned triangle pushes to the other side: give that polygon as triangles"
                     : "Within the file's rounding nothing else can be meant; unjoined they would be cracks");
      place(finding, {}, {}, note.first_W_m);
    }
  }

  void open_edges() {
    std::vector<std::array<std::int32_t, 2>> edges;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& c = mesh_.triangles[t];
      if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
      for (std::size_t e = 0; e < 3; ++e) {
        if (topology_.neighbours[t][e] == open_edge) edges.push_back({c[e], c[(e + 1) % 3]});
      }
    }
    result_.open_edges = edges.size();
    if (edges.empty()) return;
    // Loops: sets of open edges that hang together at their ends (union-find over the vertices).
    std::vector<std::int32_t> parent(mesh_.vertices_W_m.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](std::int32_t v) {
      while (parent[at(v)] != v) v = parent[at(v)] = parent[at(parent[at(v)])];
      return v;
    };
    for (const auto& [a, b] : edges) parent[at(root(a))] = root(b);
    std::vector<std::int32_t> roots;
    roots.reserve(edges.size());
    for (const auto& edge : edges) roots.push_back(root(edge[0]));
    std::sort(roots.begin(), roots.end());
    result_.boundary_loops = static_cast<std::size_t>(std::unique(roots.begin(), roots.end()) - roots.begin());
    MeshFinding& finding =
        add("open-edges", rule_.sheet ? Severity::note : Severity::matters, edges.size(),
            fmt::format("{} edges have only one triangle; they form {} boundary {}", edges.size(),
                        result_.boundary_loops, result_.boundary_loops == 1 ? "loop" : "loops"),
            "The surface does not enclose a volume: beyond its border inside and outside are not defined, and a "
            "probe can pass through a hole or around the border without being stopped.");
    for (const auto& edge : edges) place_edge(finding, edge);
  }

  void orientation() {
    const std::size_t count = topology_.disoriented_edges.size();
    if (count == 0) return;
    const bool moebius =
        std::find(pieces_.orientable.begin(), pieces_.orientable.end(), false) != pieces_.orientable.end();
    MeshFinding& finding =
        add("inconsistent-orientation", Severity::matters, pieces_.against.size(),
            fmt::format(
                "{} triangles face the other way than the rest of their piece ({} edges where neighbours disagree){}",
                pieces_.against.size(), count, moebius ? "; no turning of triangles would make them agree" : ""),
            "A flipped triangle pulls the probe in instead of pushing it out, and the force reverses where its edge is "
            "crossed.");
    for (const std::int32_t t : pieces_.against) place(finding, {t}, {}, middle(t));
  }

  void inward_facing() {
    const std::vector<std::int32_t> inward = inward_pieces(mesh_, pieces_);
    if (inward.empty()) return;
    MeshFinding& finding =
        add("inward-facing", Severity::matters, inward.size(),
            fmt::format("{} closed {} inside out: normals point inwards (volume {:.6g} m^3)", inward.size(),
                        inward.size() == 1 ? "piece is" : "pieces are", pieces_.volume_m3[at(inward[0])]),
            "Outside counts as inside: a renderer pushes the probe into the object and lets it roam freely within.");
    for (const std::int32_t piece : inward)
      place(finding, {pieces_.first[at(piece)]}, {}, middle(pieces_.first[at(piece)]));
  }

  void degenerate_triangles() {
    std::vector<std::int32_t> found;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& c = mesh_.triangles[t];
      double longest = 0.0;
      for (std::size_t e = 0; e < 3; ++e)
        longest =
            std::max(longest, (mesh_.vertices_W_m[at(c[(e + 1) % 3])] - mesh_.vertices_W_m[at(c[e])]).squaredNorm());
      if (mesh_.scaled_normal(t).norm() <= degenerate_area_ratio * longest)
        found.push_back(static_cast<std::int32_t>(t));
    }
    if (found.empty()) return;
    MeshFinding& finding = add(
        "degenerate-triangles", Severity::matters, found.size(), fmt::format("{} triangles have no area", found.size()),
        "Their normal is rounding noise: a force taken from it points anywhere, and a walk over the surface can stop "
        "at them.");
    for (const std::int32_t t : found) place(finding, {t}, {}, middle(t));
  }

  void duplicate_triangles() {
    std::vector<std::pair<std::array<std::int32_t, 3>, std::int32_t>> keys;
    keys.reserve(mesh_.triangles.size());
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      auto corners = mesh_.triangles[t];
      std::sort(corners.begin(), corners.end());
      if (corners[0] != corners[1] && corners[1] != corners[2])
        keys.emplace_back(corners, static_cast<std::int32_t>(t));
    }
    std::sort(keys.begin(), keys.end());
    std::vector<std::array<std::int32_t, 2>> found;
    for (std::size_t i = 1; i < keys.size(); ++i) {
      if (keys[i].first == keys[i - 1].first) found.push_back({keys[i - 1].second, keys[i].second});
    }
    if (found.empty()) return;
    MeshFinding& finding =
        add("duplicate-triangles", Severity::matters, found.size(),
            fmt::format("{} triangles repeat another one", found.size()),
            "One crossing counts twice: a renderer may hold two constraints where there is one surface, and inside "
            "against outside turns over.");
    for (const auto& [first, second] : found) place(finding, {first, second}, {}, middle(first));
  }

  void vertices() {
    const std::size_t joined = raw_.vertices_W_m.size() - mesh_.vertices_W_m.size();
    if (joined > 0) {
      MeshFinding& finding = add("duplicate-vertices", Severity::note, joined,
                                 fmt::format("{} vertices repeat the coordinates of another one", joined),
                                 "Touchstone joins them. A renderer that goes by indices sees a slit along each: its "
                                 "walk over the surface ends "
                                 "there.");
      std::vector<std::int32_t> order(raw_.vertices_W_m.size());
      std::iota(order.begin(), order.end(), 0);
      const auto less = [&](std::int32_t a, std::int32_t b) {
        const Vec3& p = raw_.vertices_W_m[at(a)];
        const Vec3& q = raw_.vertices_W_m[at(b)];
        return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
      };
      std::stable_sort(order.begin(), order.end(), less);
      for (std::size_t i = 1; i < order.size(); ++i) {
        if (!less(order[i - 1], order[i]))
          place(finding, {}, {order[i - 1], order[i]}, raw_.vertices_W_m[at(order[i])]);
      }
    }
    std::vector<bool> used(raw_.vertices_W_m.size(), false);
    for (const auto& triangle : raw_.triangles) {
      for (const std::int32_t v : triangle) used[at(v)] = true;
    }
    const auto unused = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
    if (unused == 0) return;
    MeshFinding& finding =
        add("unused-vertices", Severity::note, unused, fmt::format("{} vertices belong to no triangle", unused),
            "Nothing in Touchstone; a program that takes the size of the object from its vertices gets it wrong.");
    for (std::size_t v = 0; v < used.size(); ++v) {
      if (!used[v]) place(finding, {}, {static_cast<std::int32_t>(v)}, raw_.vertices_W_m[v]);
    }
  }

  void non_manifold() {
    if (!topology_.non_manifold_edges.empty()) {
      MeshFinding& finding = add(
          "non-manifold-edges", Severity::matters, topology_.non_manifold_edges.size(),
          fmt::format("{} edges belong to three or more triangles", topology_.non_manifold_edges.size()),
          "Where the surface goes on beyond such an edge is not defined: a renderer that walks over it may come out on "
          "the wrong sheet, and the side of a point closest to it is a guess.");
      for (const auto& edge : topology_.non_manifold_edges) place_edge(finding, edge);
    }
    // Vertices where fans meet although every edge there is in order.
    std::vector<std::int32_t> found;
    for (std::size_t v = 0; v < mesh_.vertices_W_m.size(); ++v) {
      if ((topology_.vertex_flags[v] & vertex_non_manifold) == 0) continue;
      const auto fan = topology_.fan(v);
      const bool by_an_edge = std::any_of(fan.begin(), fan.end(), [&](std::int32_t t) {
        const auto& n = topology_.neighbours[at(t)];
        return std::find(n.begin(), n.end(), non_manifold_edge) != n.end();
      });
      if (!by_an_edge) found.push_back(static_cast<std::int32_t>(v));
    }
    if (found.empty()) return;
    MeshFinding& finding =
        add("non-manifold-vertices", Severity::matters, found.size(),
            fmt::format("{} vertices are where several parts of the surface touch in one point", found.size()),
            "The pseudo-normal there mixes parts that do not belong together: the sign of the distance next to such a "
            "vertex can be wrong.");
    for (const std::int32_t v : found) {
      const auto fan = topology_.fan(at(v));
      place(finding, {fan.begin(), fan.end()}, {raw_index(v)}, mesh_.vertices_W_m[at(v)]);
    }
  }

  // A triangle whose normal points against at least two neighbours' that agree with each other. At a ridge, and at a
  // tip, the neighbours of a triangle do not agree.
  void folds() {
    std::vector<std::int32_t> found;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      std::vector<Vec3> against;
      for (const std::int32_t n : topology_.neighbours[t]) {
        if (n >= 0 && topology_.face_normals[at(n)].dot(topology_.face_normals[t]) < 0.0)
          against.push_back(topology_.face_normals[at(n)]);
      }
      if (against.size() < 2) continue;
      constexpr double agree = 0.5;
      bool alike = true;
      for (std::size_t i = 0; i < against.size(); ++i)
        alike = alike && against[i].dot(against[(i + 1) % against.size()]) > agree;
      if (alike) found.push_back(static_cast<std::int32_t>(t));
    }
    if (found.empty()) return;
    MeshFinding& finding = add(
        "folds", Severity::matters, found.size(),
        fmt::format("{} {} turned over against what lies around", found.size(),
                    found.size() == 1 ? "triangle is" : "triangles are"),
        "The surface is folded there, as decimation without a guard leaves it: a probe that slides into the fold is "
        "held fast, with many times the right force.");
    for (const std::int32_t t : found) place(finding, {t}, {}, middle(t));
  }

  void intersections(const SelfIntersectionCheck& check) {
    const auto pairs = check ? check(mesh_) : std::nullopt;
    result_.self_intersection_checked = pairs.has_value();
    if (!pairs || pairs->empty()) return;
    MeshFinding& finding =
        add("self-intersections", Severity::matters, pairs->size(),
            fmt::format("{} pairs of triangles cut through one another", pairs->size()),
            "Part of the surface lies inside the object: a probe that slides along it meets a wall that it should not "
            "feel, or is caught in the fold.");
    for (const auto& [first, second] : *pairs)
      place(finding, {first, second}, {}, 0.5 * (middle(first) + middle(second)));
  }

  void components() {
    if (pieces_.count() <= 1) return;
    std::vector<std::size_t> sizes(pieces_.count(), 0);
    for (const std::int32_t piece : pieces_.piece) ++sizes[at(piece)];
    MeshFinding& finding = add(
        "components", Severity::note, pieces_.count(),
        fmt::format("{} separate pieces; the smallest has {} triangles", pieces_.count(),
                    *std::min_element(sizes.begin(), sizes.end())),
        "Nothing when they are separate bodies. Left-over specks of a scan are felt as grains, and pieces that touch "
        "have no common edge to slide over.");
    for (const std::int32_t first : pieces_.first) place(finding, {first}, {}, middle(first));
  }

  const TriangleMesh& raw_;
  const MeshDoctorRule& rule_;
  TriangleMesh mesh_;
  MeshTopology topology_;
  MeshPieces pieces_;
  MeshDiagnosis result_;
};

}  // namespace

bool MeshDiagnosis::sound() const noexcept {
  return std::none_of(findings.begin(), findings.end(),
                      [](const MeshFinding& f) { return f.severity == Severity::matters; });
}

MeshDiagnosis examine_mesh(const TriangleMesh& mesh, const MeshDoctorRule& rule,
                           const SelfIntersectionCheck& self_intersections) {
  return Examination(mesh, rule).run(self_intersections);
}

}  // namespace touchstone::surface
