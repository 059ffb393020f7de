"""The god-object of Zilles and Salisbury (IROS 1995) on a triangle mesh, in Python: a frictionless proxy that stays on the
surface while the tip is inside, as near to the tip as it gets, and a spring between them.

The proxy is on a face, an edge or a vertex that is known by its number. It walks from one to the next while that brings it
nearer to the tip, and leaves the surface when the tip is in front of it. Nothing is called small but rounding.

    pytest --touchstone god_object.py
"""

import math

import numpy as np

import touchstone as ts

# Against rounding: lengths below this share of the mesh's size are nothing. Crossings are computed from coordinates of
# that size with a unit of rounding of 1.1e-16 in each of some ten operations.
ROUNDING = 1e-13
# Moves without coming nearer to the tip before the walk gives up: exact arithmetic needs none, rounding a few at a vertex.
PATIENCE = 64


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def along(a, t, d):
    return (a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(dot(a, a))
    return (a[0] / length, a[1] / length, a[2] / length) if length > 0.0 else (0.0, 0.0, 0.0)


class Walkable:
    """A mesh with its neighbours. Side i of a face runs from its corner i to corner (i + 1) % 3."""

    def __init__(self, vertices_m, triangles):
        # Corners at one place are one corner, and triangles without area cannot be touched.
        places, same = np.unique(vertices_m + 0.0, axis=0, return_inverse=True)
        triangles = same.reshape(-1)[triangles]
        a, b, c = (places[triangles[:, i]] for i in range(3))
        normals = np.cross(b - a, c - a)
        length = np.linalg.norm(normals, axis=1)
        kept = length > 0.0
        self.a, self.b, self.c = a[kept], b[kept], c[kept]
        self.normals = normals[kept] / length[kept, None]
        self.double_area = length[kept]
        self.tolerance = ROUNDING * float(np.abs(places).max())

        self.places = [tuple(place) for place in places.tolist()]
        self.faces = [tuple(face) for face in triangles[kept].tolist()]
        self.n = [tuple(n) for n in self.normals.tolist()]
        # For each side of a face: its inward normal in the plane of the face.
        self.inward = [
            tuple(unit(cross(self.n[f], sub(self.places[face[(i + 1) % 3]], self.places[face[i]]))) for i in range(3))
            for f, face in enumerate(self.faces)
        ]
        self.sides = {}  # two corners to the faces at that edge, with the number of the side
        self.fan = {}  # corner to its faces, with its number in each
        self.vertex_normal = {}  # angle-weighted (Baerentzen and Aanaes 2005)
        for f, face in enumerate(self.faces):
            for i in range(3):
                self.sides.setdefault(frozenset((face[i], face[(i + 1) % 3])), []).append((f, i))
                self.fan.setdefault(face[i], []).append((f, i))
                one = unit(sub(self.places[face[(i + 1) % 3]], self.places[face[i]]))
                two = unit(sub(self.places[face[(i + 2) % 3]], self.places[face[i]]))
                angle = math.acos(max(-1.0, min(1.0, dot(one, two))))
                self.vertex_normal[face[i]] = along(self.vertex_normal.get(face[i], (0.0, 0.0, 0.0)), angle, self.n[f])
        self.rim = {corner for edge, faces in self.sides.items() if len(faces) == 1 for corner in edge}
        self.valleys = {edge for edge, faces in self.sides.items() if len(faces) == 2 and self.is_valley(edge, faces)}

    def is_valley(self, edge, faces):
        """Concave seen from outside: by the free corner that reaches farther from the other face's plane."""
        (f, _), (g, _) = faces
        reach = [max((self.height(plane, self.places[c]) for c in self.faces[other] if c not in edge), key=abs, default=0.0)
                 for plane, other in ((f, g), (g, f))]
        return max(reach, key=abs) > 0.0

    def height(self, f, x):
        return dot(self.n[f], sub(x, self.places[self.faces[f][0]]))

    def inside(self, f, i, x):
        return dot(self.inward[f][i], sub(x, self.places[self.faces[f][i]]))

    def edge(self, f, i):
        return frozenset((self.faces[f][i], self.faces[f][(i + 1) % 3]))

    def is_free(self, edge, p):
        """Whether the tip is outside both planes of a valley, outside one of a ridge."""
        heights = [self.height(f, p) for f, _ in self.sides[edge]]
        return all(h >= 0.0 for h in heights) if edge in self.valleys or len(heights) > 2 else any(h >= 0.0 for h in heights)

    def closest(self, p):
        """The closest face, and which of its corners share the closest place: three, two of an edge, or one."""
        # Ericson, Real-Time Collision Detection, section 5.1.5, of all faces at once, by the regions of each side.
        best, found = math.inf, None
        p = np.asarray(p)
        corners = (self.a, self.b, self.c)
        height = np.einsum("ij,ij->i", self.normals, p - self.a)
        foot = p - height[:, None] * self.normals
        within = np.ones(len(self.faces), bool)
        for i in range(3):
            start, end = corners[i], corners[(i + 1) % 3]
            line = end - start
            within &= np.einsum("ij,ij->i", np.cross(line, foot - start), self.normals) >= 0.0
            share = np.clip(np.einsum("ij,ij->i", p - start, line) / np.einsum("ij,ij->i", line, line), 0.0, 1.0)
            away = np.linalg.norm(p - (start + share[:, None] * line), axis=1)
            f = int(away.argmin())
            if away[f] < best:
                ends = (self.faces[f][i], self.faces[f][(i + 1) % 3])
                best = float(away[f])
                found = (f, ends[:1] if share[f] == 0.0 else ends[1:] if share[f] == 1.0 else ends)
        above = np.where(within, np.abs(height), np.inf)
        f = int(above.argmin())
        return (f, self.faces[f]) if above[f] < best else found

    def crossing(self, start, goal, apart_from, floor):
        """The first face that the way from start to goal enters, and where; None if there is none."""
        way = np.subtract(goal, start)
        height = np.einsum("ij,ij->i", self.normals, np.asarray(start) - self.a)
        falls = self.normals @ way
        candidates = np.flatnonzero((falls < 0.0) & (height >= -self.tolerance) & (height + falls < 0.0))
        length = math.sqrt(float(way @ way))
        best = None
        for f in candidates.tolist():
            if f in apart_from:
                continue
            t = max(0.0, height[f] / -falls[f])
            if best is not None and (t - best[0]) * length > self.tolerance:
                continue
            point = np.asarray(start) + t * way
            # Areas opposite to the corners, as shares: in the triangle where none is negative.
            at = point - self.a[f]
            share_b = np.dot(np.cross(at, self.c[f] - self.a[f]), self.normals[f])
            share_c = np.dot(np.cross(self.b[f] - self.a[f], at), self.normals[f])
            area = self.double_area[f]
            margin = self.tolerance * math.sqrt(area)
            if share_b < -margin or share_c < -margin or share_b + share_c > area + margin:
                continue
            # Where bodies meet, several are crossed at once: the one on which the way goes on, and of such the floor that
            # the proxy was on. Two blocks with flush tops are one.
            point, way_on = tuple(point.tolist()), tuple(way.tolist())
            goes_on = all(self.inside(f, i, point) > self.tolerance or dot(way_on, self.inward[f][i]) >= 0.0 for i in range(3))
            rank = (goes_on, dot(self.n[f], floor))
            if best is None or (t - best[0]) * length < -self.tolerance or rank > best[3]:
                best = (t, f, point, rank)
        return None if best is None else (best[1], best[2])


class GodObject(ts.Renderer):
    name = "god-object-in-python"
    summary = "Frictionless god-object for point tips, in Python"
    source = "Zilles and Salisbury, A constraint-based god-object method for haptic display, IROS 1995"
    parameters = [ts.Parameter("stiffness_N_per_m", "N/m", 1e-9, 1e9, 500.0, "k of F = k dx")]
    cannot = {"ball_tip": "renders a point"}
    golden_like = "god-object"

    def __init__(self, vertices_m, triangles, stiffness_N_per_m):
        self.stiffness = stiffness_N_per_m
        self.mesh = Walkable(vertices_m, triangles)
        self.reset()

    def reset(self):
        self.proxy = None  # where it is; None before the first step
        self.push = (0.0, 0.0, 0.0)  # from the tip to the proxy
        self.floor = (0.0, 0.0, 0.0)  # the normal of the last face on which a step ended
        self.on = None  # ("face", f), ("edge", {two corners}), ("vertex", corner), or None in free space

    def step(self, tip):
        goal = tuple(tip.position_m.tolist())
        if self.proxy is None:
            self.start(goal)
        self.follow(goal)
        if self.on is None:
            return ts.Step.free(tip)
        if self.on[0] == "face":
            self.floor = normal = self.mesh.n[self.on[1]]
        else:
            normal = unit(self.push)
        k = self.stiffness
        depth = math.sqrt(dot(self.push, self.push))
        return ts.Step((k * self.push[0], k * self.push[1], k * self.push[2]), self.proxy, normal, depth, True)

    def start(self, goal):
        """Free, or inside a body on the closest place of its surface. Beyond the rim of an open mesh there is no inside."""
        self.proxy = goal
        mesh = self.mesh
        f, corners = mesh.closest(goal)
        if len(corners) == 3:
            outward, self.on = mesh.n[f], ("face", f)
        elif len(corners) == 2:
            edge = frozenset(corners)
            outward = (0.0, 0.0, 0.0)
            for g, _ in mesh.sides[edge]:
                outward = along(outward, 1.0, mesh.n[g])
            self.on = ("edge", edge)
        else:
            outward, self.on = mesh.vertex_normal[corners[0]], ("vertex", corners[0])
        place = mesh.places[corners[0]]
        on_rim = len(corners) < 3 and mesh.rim.issuperset(corners)
        if on_rim or dot(outward, sub(goal, place)) >= 0.0:
            self.on = None
        else:
            # Where on it does not matter: it comes to rest on the closest point.
            self.proxy = tuple(sum(mesh.places[c][axis] for c in corners) / len(corners) for axis in range(3))

    def follow(self, goal):
        """From one neighbour to the next, to the place of the surface that is nearest to the goal."""
        least, patience = math.inf, PATIENCE
        moves = {"face": self.on_face, "edge": self.on_edge, "vertex": self.at_vertex}
        while patience > 0:
            done = self.leave(goal, ()) if self.on is None else moves[self.on[0]](self.on[1], goal)
            if done:
                return
            away = sub(goal, self.proxy)
            left = dot(away, away)
            patience = PATIENCE if left < least else patience - 1
            least = min(least, left)
        self.push = sub(self.proxy, goal)

    # Each of these returns whether the proxy has come to rest.

    def rest(self, proxy, push):
        self.proxy, self.push = proxy, push
        return True

    def leave(self, goal, apart_from):
        """Straight to the goal, up to the first face that it would enter."""
        hit = self.mesh.crossing(self.proxy, goal, apart_from, self.floor)
        if hit is None:
            self.on = None
            return self.rest(goal, (0.0, 0.0, 0.0))
        self.on, self.proxy = ("face", hit[0]), hit[1]
        return False

    def on_face(self, f, goal):
        mesh = self.mesh
        height = mesh.height(f, goal)
        if height >= 0.0:
            return self.leave(goal, (f,))
        push = (-height * mesh.n[f][0], -height * mesh.n[f][1], -height * mesh.n[f][2])
        foot = along(goal, 1.0, push)
        # Over the border that the straight way within the plane meets first.
        first, exits = 2.0, []
        for i in range(3):
            there = mesh.inside(f, i, goal)
            if there >= 0.0:
                continue
            here = max(0.0, mesh.inside(f, i, self.proxy))
            share = here / (here - there)
            if share < first:
                first, exits = share, [i]
            elif share == first:
                exits.append(i)
        if not exits:
            return self.rest(foot, push)
        if len(exits) == 2:
            (corner,) = mesh.edge(f, exits[0]) & mesh.edge(f, exits[1])
            return self.to_vertex(corner)
        start, end = mesh.faces[f][exits[0]], mesh.faces[f][(exits[0] + 1) % 3]
        line = sub(mesh.places[end], mesh.places[start])
        share = dot(sub(along(self.proxy, first, sub(foot, self.proxy)), mesh.places[start]), line) / dot(line, line)
        if share <= 0.0 or share >= 1.0:
            return self.to_vertex(start if share <= 0.0 else end)
        self.proxy, self.on = along(mesh.places[start], share, line), ("edge", mesh.edge(f, exits[0]))
        return False

    def to_vertex(self, corner):
        self.proxy, self.on = self.mesh.places[corner], ("vertex", corner)
        return False

    def on_edge(self, edge, goal):
        mesh = self.mesh
        sides = mesh.sides[edge]
        faces = [f for f, _ in sides]
        if len(sides) > 1 and mesh.is_free(edge, goal):
            return self.leave(goal, faces)
        # Into a face's strip. From a ridge both may lead down: the steeper one. Where two bodies meet, four faces do: the
        # proxy stays on its floor.
        into = [(dot(mesh.n[f], self.floor) if len(sides) > 2 else mesh.inside(f, i, goal), -f) for f, i in sides
                if mesh.inside(f, i, goal) > 0.0 and mesh.height(f, goal) < 0.0]
        if into:
            self.on = ("face", -max(into)[1])
            return False
        if len(sides) == 1:
            # Past the rim of a sheet there is nothing to hold the proxy.
            return self.leave(goal, faces)
        if any(mesh.inside(f, i, goal) > 0.0 for f, i in sides):
            # In front of a face, in its strip: free. In a valley only where its two planes are one to rounding.
            return self.leave(goal, faces)
        start, end = sorted(edge)
        line = sub(mesh.places[end], mesh.places[start])
        # Asked from both ends as at_vertex() does, so that the two never disagree.
        after, before = dot(sub(goal, mesh.places[start]), line), -dot(sub(goal, mesh.places[end]), line)
        if after <= 0.0 or before <= 0.0:
            return self.to_vertex(start if after <= 0.0 else end)
        proxy = along(mesh.places[start], after / (after + before), line)
        return self.rest(proxy, sub(proxy, goal))

    def at_vertex(self, corner, goal):
        """Down the steepest way: to the closest point of the infinite cone of the faces and edges about the vertex."""
        mesh = self.mesh
        place = mesh.places[corner]
        to_goal = sub(goal, place)
        steepest, way = 0.0, None
        faces = [f for f, _ in mesh.fan[corner]]
        for f, i in mesh.fan[corner]:
            if mesh.inside(f, i, goal) >= 0.0 and mesh.inside(f, (i + 2) % 3, goal) >= 0.0:
                height = mesh.height(f, goal)
                flat = along(to_goal, -height, mesh.n[f])
                if dot(flat, flat) > steepest:
                    steepest, way = dot(flat, flat), ("face", f, height >= 0.0)
            for other, side in ((mesh.faces[f][(i + 1) % 3], i), (mesh.faces[f][(i + 2) % 3], (i + 2) % 3)):
                line = sub(mesh.places[other], place)
                reach = dot(to_goal, line)
                edge = mesh.edge(f, side)
                if reach > 0.0 and len(mesh.sides[edge]) > 1 and reach * reach / dot(line, line) > steepest:
                    steepest, way = reach * reach / dot(line, line), ("edge", edge, mesh.is_free(edge, goal))
        if way is None:
            if corner in mesh.rim or dot(mesh.vertex_normal[corner], to_goal) > 0.0 or to_goal == (0.0, 0.0, 0.0):
                return self.leave(goal, faces)
            return self.rest(place, sub(place, goal))
        if way[2]:
            return self.leave(goal, faces)
        self.on = way[:2]
        return False
