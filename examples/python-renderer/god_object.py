"""The god-object of Zilles and Salisbury (IROS 1995) on a triangle mesh, in Python: a frictionless proxy that stays on the
surface while the tip is inside, as near to the tip as it gets, and a spring between them.

The proxy is on a face, an edge or a vertex that is known by its number. It walks from one to the next while that brings it
nearer to the tip, and leaves the surface when the tip is in front of it.

    pytest --touchstone god_object.py
"""

import math

import numpy as np

import touchstone as ts

# Against rounding: lengths below this share of the mesh's size are nothing. Crossings are computed from coordinates of
# that size with a unit of rounding of 1.1e-16 in each of some ten operations.
ROUNDING = 1e-13


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


class GodObject(ts.Renderer):
    name = "god-object-in-python"
    summary = "Frictionless god-object for point tips, in Python"
    source = "Zilles and Salisbury, A constraint-based god-object method for haptic display, IROS 1995"
    parameters = [ts.Parameter("stiffness_N_per_m", "N/m", 1e-9, 1e9, 500.0, "k of F = k dx")]
    cannot = {
        "ball_tip": "renders a point",
        "start_inside": "finds contact when the tip crosses the surface",
    }
    golden_like = "god-object"

    def __init__(self, vertices_m, triangles, stiffness_N_per_m):
        self.stiffness = stiffness_N_per_m
        # Corners at one place are one corner, and triangles without area cannot be touched.
        places, same = np.unique(vertices_m + 0.0, axis=0, return_inverse=True)
        triangles = same.reshape(-1)[triangles]
        a, b, c = (places[triangles[:, i]] for i in range(3))
        normals = np.cross(b - a, c - a)
        length = np.linalg.norm(normals, axis=1)
        kept = length > 0.0
        self.a, self.b, self.c = a[kept], b[kept], c[kept]
        self.normals = normals[kept] / length[kept, None]
        self.size = float(np.ptp(places, axis=0).max())
        self.edge_ab, self.edge_ac = self.b - self.a, self.c - self.a
        self.double_area = length[kept]

        self.places = [tuple(place) for place in places.tolist()]
        self.faces = [tuple(face) for face in triangles[kept].tolist()]
        self.n = [tuple(n) for n in self.normals.tolist()]
        # For each side of a face: its inward normal in the plane of the face.
        self.inward = [
            tuple(unit(cross(self.n[f], sub(self.places[face[(i + 1) % 3]], self.places[face[i]]))) for i in range(3))
            for f, face in enumerate(self.faces)
        ]
        self.sides = {}  # two corners to the faces at that edge, with the number of the side
        self.at_vertex = {}  # corner to its faces
        for f, face in enumerate(self.faces):
            for i in range(3):
                self.sides.setdefault(frozenset((face[i], face[(i + 1) % 3])), []).append((f, i))
                self.at_vertex.setdefault(face[i], []).append(f)
        self.reset()

    def reset(self):
        self.last = None  # the tip before; the proxy is there while it is free
        self.proxy = None  # where the proxy is on the surface, or None
        self.floor = (0.0, 0.0, 0.0)  # the normal of the last face on which a step ended
        self.on = None  # ("face", f), ("edge", {two corners}) or ("vertex", corner)

    def step(self, tip):
        goal = tuple(tip.position_m.tolist())
        if self.proxy is None:
            start = goal if self.last is None else self.last
            self.move_freely(start, goal, ())
        if self.proxy is not None:
            self.walk(goal)
        if self.on is not None and self.on[0] == "face":
            self.floor = self.n[self.on[1]]
        self.last = goal
        if self.proxy is None:
            return ts.Step.free(tip)
        to_proxy = sub(self.proxy, goal)
        depth = math.sqrt(dot(to_proxy, to_proxy))
        if depth == 0.0:
            return ts.Step((0.0, 0.0, 0.0), goal, contact=False)
        k = self.stiffness
        return ts.Step((k * to_proxy[0], k * to_proxy[1], k * to_proxy[2]), self.proxy, unit(to_proxy), depth, True)

    # --- Free space ---

    def move_freely(self, start, goal, apart_from):
        """The proxy goes straight to the goal, up to the first face that it would enter."""
        way = np.subtract(goal, start)
        height = np.einsum("ij,ij->i", self.normals, np.asarray(start) - self.a)
        falls = self.normals @ way
        tolerance = ROUNDING * self.size
        candidates = np.flatnonzero((falls < 0.0) & (height >= -tolerance) & (height + falls < 0.0))
        length = math.sqrt(float(way @ way))
        best = None
        for f in candidates.tolist():
            if f in apart_from:
                continue
            t = max(0.0, height[f] / -falls[f])
            if best is not None and (t - best[0]) * length > tolerance:
                continue
            point = np.asarray(start) + t * way
            # Areas opposite to the corners, as shares: in the triangle where none is negative.
            at = point - self.a[f]
            share_b = np.dot(np.cross(at, self.edge_ac[f]), self.normals[f])
            share_c = np.dot(np.cross(self.edge_ab[f], at), self.normals[f])
            area = self.double_area[f]
            edge = tolerance * math.sqrt(area)
            if share_b < -edge or share_c < -edge or share_b + share_c > area + edge:
                continue
            # Where bodies meet, several are crossed at once: the one on which the way goes on, and of such the floor that
            # the proxy was on. Two blocks with flush tops are one.
            point, way_on = tuple(point.tolist()), tuple(way.tolist())
            goes_on = all(
                dot(sub(point, self.places[corner]), inward) > tolerance or dot(way_on, inward) >= 0.0
                for corner, inward in zip(self.faces[f], self.inward[f])
            )
            rank = (goes_on, dot(self.n[f], self.floor))
            if best is None or (t - best[0]) * length < -tolerance or rank > best[3]:
                best = (t, f, point, rank)
        if best is None:
            self.proxy = self.on = None
        else:
            self.proxy = best[2]
            self.on = ("face", best[1])

    # --- On the surface ---

    def walk(self, goal):
        """To the place of the surface that is nearest to the goal, from one neighbour to the next."""
        # Each move shortens the way to the goal; more of them than twice the faces can only be rounding.
        for _ in range(2 * len(self.faces) + 10):
            kind, where = self.on
            if kind == "face":
                moved = self.walk_on_face(where, goal)
            elif kind == "edge":
                moved = self.walk_on_edge(where, goal)
            else:
                moved = self.walk_at_vertex(where, goal)
            if not moved or self.proxy is None:
                return

    def walk_on_face(self, f, goal):
        n = self.n[f]
        to_goal = sub(goal, self.proxy)
        height = dot(n, sub(goal, self.places[self.faces[f][0]]))
        if height >= 0.0:
            self.move_freely(self.proxy, goal, (f,))
            return self.proxy is not None
        way = along(to_goal, -dot(n, to_goal), n)
        exit_at, exit_side = 1.0, None
        for i in range(3):
            rate = dot(way, self.inward[f][i])
            if rate >= 0.0:
                continue
            inside = dot(sub(self.proxy, self.places[self.faces[f][i]]), self.inward[f][i])
            t = max(0.0, inside / -rate)
            if t < exit_at:
                exit_at, exit_side = t, i
        if exit_side is None:
            self.proxy = along(goal, -height, n)
            return False
        corners = frozenset((self.faces[f][exit_side], self.faces[f][(exit_side + 1) % 3]))
        self.put_on_edge(corners, along(self.proxy, exit_at, way))
        return True

    def put_on_edge(self, corners, near):
        """On the edge at the point nearest to `near`; on one of its corners where that is as near."""
        u, v = sorted(corners)
        start, end = self.places[u], self.places[v]
        line = sub(end, start)
        square = dot(line, line)
        share = dot(sub(near, start), line) / square
        tolerance = ROUNDING * self.size / math.sqrt(square)
        if share <= tolerance:
            self.proxy, self.on = start, ("vertex", u)
        elif share >= 1.0 - tolerance:
            self.proxy, self.on = end, ("vertex", v)
        else:
            self.proxy, self.on = along(start, share, line), ("edge", corners)

    def leave(self, faces, goal):
        """Leaves the surface where the goal is in front of it: in front of all faces, or of one of a ridge's."""
        self.move_freely(self.proxy, goal, faces)
        return self.proxy is not None

    def walk_on_edge(self, corners, goal):
        to_goal = sub(goal, self.proxy)
        best, best_face = 0.0, None
        fronts = []
        for f, i in self.sides[corners]:
            fronts.append(dot(self.n[f], to_goal) > 0.0)
            into = dot(to_goal, self.inward[f][i])
            if into <= 0.0:
                continue
            # Where two bodies meet, four faces do: the proxy stays on its floor. Else at most one leads nearer.
            rank = 2.0 + dot(self.n[f], self.floor) if len(self.sides[corners]) > 2 else into
            if rank > best:
                best, best_face = rank, f
        if all(fronts) and len(fronts) > 1:
            return self.leave([f for f, _ in self.sides[corners]], goal)
        if best_face is not None:
            self.on = ("face", best_face)
            return True
        if len(self.sides[corners]) == 1:
            # Past the rim of a sheet there is nothing to hold the proxy.
            return self.leave([f for f, _ in self.sides[corners]], goal)
        u, v = sorted(corners)
        line = sub(self.places[v], self.places[u])
        share = dot(sub(goal, self.places[u]), line) / dot(line, line)
        before = self.proxy
        self.put_on_edge(corners, along(self.places[u], min(1.0, max(0.0, share)), line))
        return self.on[0] == "vertex" and self.proxy != before

    def walk_at_vertex(self, corner, goal):
        to_goal = sub(goal, self.proxy)
        faces = self.at_vertex[corner]
        if all(dot(self.n[f], to_goal) > 0.0 for f in faces):
            return self.leave(faces, goal)
        best, choice = 0.0, None
        for f in faces:
            face = self.faces[f]
            i = face.index(corner)
            # Between the two sides that meet here, downhill on the face.
            height = dot(self.n[f], to_goal)
            way = along(to_goal, -height, self.n[f])
            if dot(way, self.inward[f][i]) > 0.0 and dot(way, self.inward[f][(i + 2) % 3]) > 0.0:
                gain = dot(way, way)
                if gain > best:
                    best, choice = gain, ("face", f)
            for other in (face[(i + 1) % 3], face[(i + 2) % 3]):
                line = unit(sub(self.places[other], self.proxy))
                gain = dot(line, to_goal)
                if gain > 0.0 and gain * gain > best:
                    best, choice = gain * gain, ("edge", frozenset((corner, other)))
        if choice is None:
            return False
        if choice[0] == "face":
            self.on = choice
            return True
        before = self.proxy
        u, v = sorted(choice[1])
        line = sub(self.places[v], self.places[u])
        share = dot(sub(goal, self.places[u]), line) / dot(line, line)
        self.put_on_edge(choice[1], along(self.places[u], min(1.0, max(0.0, share)), line))
        return self.proxy != before
