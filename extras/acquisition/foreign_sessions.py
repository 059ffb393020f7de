#!/usr/bin/env python3
"""Acquisition sessions from a simulator that shares no code with `touchstone acquire`, and what becomes of them.

    foreign_sessions.py TOUCHSTONE SEED COUNT undisturbed|disturbed [KIND]

KIND: one of KINDS, or "later gain", which changes after the static poses and is said, not refused. Said, too, is a move
that no contact shows: along the ridge, which is the same everywhere.

Exit status 0: every session is refused (exit status not 0) or right; 1: some are silently wrong, or more than 2 % of the
undisturbed ones are refused; 77: numpy is missing.
Sources. Hand: straight strokes of least jerk (Flash and Hogan, J. Neuroscience 5 (1985) 1688), carried by a mass on a
spring and damper that follows a virtual path into the surface (Hogan, J. Dyn. Sys. Meas. Control 107 (1985) 1; 0.2 to
0.4 kg, 250 to 600 N/m), tremor of 8 to 12 Hz. Contact: Kelvin-Voigt, Coulomb friction. Sensor: Newton and Euler for the
tool that hangs on it (Goldstein, Classical Mechanics, 4.9 and 5.5). Rotations: Rodrigues' parameters (Altmann 1986).
Surfaces: torus, ellipsoid, and a plate with a ridge, z(x, y) with exact normals.
Wrong: the ball's centre is off by more than 1 mm (root mean square) or 3 mm (worst) while it scans, or the force, both
smoothed to the same bandwidth, by more than 3 % of its root mean square and 0.1 N (a quarter of
the contact force, the limit that acquire states). The inertia of the tool, which stays in a recording
(docs/how-to/acquire.md), counts as force.
"""
import os
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError:
    sys.exit(77)

RATE = 4000.0
G = np.array([0, 0, -9.81])
KINDS = ('knock early', 'knock late', 'drift', 'frozen', 'swapped', 'moved', 'tip', 'frame', 'statics', 'packets',
         'clock', 'lever', 'cable', 'gain', 'scale', 'radius')


def product(p, q):
    s, v, t, w = p[..., :1], p[..., 1:], q[..., :1], q[..., 1:]
    return np.concatenate([s * t - np.sum(v * w, -1, keepdims=True), s * w + t * v + np.cross(v, w)], -1)


def inverse(q):
    return q * np.array([1, -1, -1, -1])


def turned(q, v):
    v = np.broadcast_to(v, np.broadcast_shapes(np.shape(v)[:-1], q.shape[:-1]) + (3,))
    return product(product(q, np.concatenate([np.zeros(v.shape[:-1] + (1,)), v], -1)), inverse(q))[..., 1:]


def rotation(vector):
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    return np.concatenate([np.cos(angle / 2), np.sinc(angle / 2 / np.pi) / 2 * vector], -1)


def least_jerk(u):
    u = np.clip(u, 0, 1)
    return u**3 * (10 - 15 * u + 6 * u**2)


class Session:
    def __init__(self, seed, kind):
        self.kind, self.rng = kind, np.random.default_rng([seed, 20261127])
        r, u = self.rng, self.rng.uniform
        self.surface = ('torus', 'ellipsoid', 'ridge')[r.integers(3)]
        self.sizes = {'torus': (u(.07, .1), u(.03, .05)), 'ellipsoid': (u(.08, .12), u(.07, .1), u(.03, .06)),
                      'ridge': (u(.004, .01), u(.015, .03), u(-.1, .1))}[self.surface]
        self.middle = np.array([self.sizes[0], 0]) if self.surface == 'torus' else np.zeros(2)
        self.mass, self.ball = u(.05, .3), u(1e-3, 4e-3)
        self.com, self.tip_s = np.array([u(-4, 4), u(-4, 4), u(15, 45)]) / 1e3, np.array([u(-3, 3), u(-3, 3), u(50, 95)]) / 1e3
        self.tip_p = np.array([u(-40, 40), u(-40, 40), u(80, 150)]) / 1e3
        self.inertia = self.mass * u(1e-4, 6e-4, 3)
        self.q_ps, self.q_tw, self.origin = rotation(self.direction() * u(0, 3)), rotation(self.direction() * u(0, 3)), u(-.5, .5, 3)
        self.bias, self.torque_bias = self.direction() * u(.5, 5), self.direction() * u(.005, .06)
        self.offset, self.skew = u(-3, 3), u(-60e-6, 60e-6)
        self.frames = (60.0, 100.0, 120.0)[r.integers(3)]
        self.stiffness, self.friction = np.exp(u(np.log(3e3), np.log(2e4))), u(.1, .45)
        self.size, self.side, self.keeps = u(), self.direction(), u() < .5
        self.move()

    def direction(self):
        v = self.rng.normal(size=3)
        return v / np.linalg.norm(v)

    def height(self, x, y):
        """z, and its slopes."""
        a, b = self.sizes[0], self.sizes[1]
        if self.surface == 'torus':
            rho = np.hypot(x, y)
            z = np.sqrt(np.maximum(b**2 - (rho - a)**2, 1e-8))
            return z, -(rho - a) / z * x / rho, -(rho - a) / z * y / rho
        if self.surface == 'ellipsoid':
            c = self.sizes[2]
            z = c * np.sqrt(np.maximum(1 - (x / a)**2 - (y / b)**2, 1e-6))
            return z, -c * c * x / (a * a * z), -c * c * y / (b * b * z)
        bell = a * np.exp(-x * x / (2 * b * b))
        return bell + self.sizes[2] * y, -x / (b * b) * bell, np.full_like(y, self.sizes[2])

    def normal(self, x, y):
        _, sx, sy = self.height(x, y)
        n = np.stack([-sx, -sy, np.ones_like(x)], -1)
        return n / np.linalg.norm(n, axis=-1, keepdims=True)

    def strokes(self, t, begin, end):
        """Places on the surface: at rest in the middle, strokes between random places, back."""
        u, at, now = self.rng.uniform, begin, np.zeros(2)
        reach = .6 * self.sizes[1] if self.surface == 'torus' else .035
        path = np.zeros((len(t), 2))
        while at < end:
            to = u(-reach, reach, 2) if at < end - 1.5 else np.zeros(2)
            takes = max(.35, 1.875 * np.linalg.norm(to - now) / u(.03, .15))
            share = least_jerk((t - at) / takes)[:, None]
            path += share * (to - now)
            now, at = to, at + takes + u(0, .15)
        self.back = at
        return path + self.middle

    def move(self):
        u, r = self.rng.uniform, self.rng
        at, taps = u(1.5, 2.5), []
        for _ in range(4):
            taps.append(at)
            at += u(.6, 1.1)
        self.begin, self.end = at + u(.5, 1), at + u(17, 22)
        t = np.arange(0, self.end + 12, 1 / RATE)
        place = self.strokes(t, self.begin + 1, self.end)
        self.end, at = self.back, self.back + u(1.8, 2.2)
        for _ in range(4):
            taps.append(at)
            at += u(.6, 1.1)
        t = t[t < at + 1]
        place = place[:len(t)]
        tremor = lambda size: size * sum(np.sin(2 * np.pi * u(8, 12) * t + u(0, 6)) for _ in range(3)) / 3
        place = place + np.stack([tremor(1e-4), tremor(1e-4)], -1)
        # The virtual path of the hand, along the normal: 0 is touching.
        spring, body, air = u(250, 600), u(.2, .4), u(.012, .022)
        push = 1.3 + sum(u(.1, .35) * np.sin(2 * np.pi * u(.1, 1.5) * t + u(0, 6)) for _ in range(3)) + tremor(.1)
        scans = least_jerk((t - self.begin) / .7) * least_jerk((self.end - t) / .7)
        goal = air + scans * (-push / spring - air) + 1e-3 * np.sin(1.9 * t)
        for tap in taps:
            goal = goal - (air + u(5e-3, 9e-3)) * least_jerk(1 - np.abs(t - tap) / u(.18, .26))
        damper, rate = 1.4 * np.sqrt(spring * body), np.gradient(goal, t)
        k, c, dt = self.stiffness, u(2, 10), 1 / RATE
        h, v, depth, force = float(goal[0]), 0.0, np.empty(len(t)), np.empty(len(t))
        for i, (g, w) in enumerate(zip(goal.tolist(), rate.tolist())):
            n = max(0.0, -k * h - c * v) if h < 0 else 0.0
            depth[i], force[i] = h, n
            v += dt * (spring * (g - h) + damper * (w - v) + n) / body
            h += dt * v
        n = self.normal(place[:, 0], place[:, 1])
        foot = np.column_stack([place, self.height(place[:, 0], place[:, 1])[0]])
        self.t, self.center = t, foot + n * (self.ball + depth)[:, None]
        slip = np.gradient(foot, t, axis=0)
        slip -= n * np.sum(slip * n, -1, keepdims=True)
        slip /= np.sqrt(np.sum(slip**2, -1, keepdims=True) + 1e-6)
        self.force = force[:, None] * (n - self.friction * slip)
        self.foot = -self.ball * n
        wander = lambda size: size * sum(np.sin(2 * np.pi * u(.05, .5) * t + u(0, 6)) for _ in range(3)) / 2
        self.q_ws = product(rotation(np.stack([wander(.3) + tremor(2e-3), wander(.3), wander(.5)], -1)),
                            rotation(np.array([np.pi, 0, 0])))
        self.taps = taps

    def moved(self, t):
        return least_jerk(t - (self.begin + self.end) / 2)[:, None]

    def move_is_hidden(self):
        """The object slid along its own surface: across that direction by less than what counts as wrong."""
        if self.kind != 'moved' or self.surface != 'ridge':
            return False
        along = np.array([0, 1, self.sizes[2]]) / np.hypot(1, self.sizes[2])
        return (2e-3 + 6e-3 * self.size) * np.linalg.norm(np.cross(along, self.side)) < 1e-3

    def in_tracker(self, t, p):
        if self.kind == 'moved':
            p = p + self.moved(t) * (2e-3 + 6e-3 * self.size) * self.side
        return turned(self.q_tw, p) + self.origin

    def wrench(self):
        t, q = self.t, inverse(self.q_ws)
        rate = lambda a: np.gradient(a, t, axis=0)
        spin = 2 * product(q, rate(self.q_ws))[:, 1:]
        com_w = self.center + turned(self.q_ws, self.com - self.tip_s)
        self.inertial = -self.mass * rate(rate(com_w))
        own = turned(q, self.mass * turned(inverse(self.q_tw), G) + self.inertial)
        if self.kind == 'cable':
            own = own + turned(q, -(2 + 8 * self.size) * (self.center - self.center[0]))
        felt = turned(q, self.force)
        lever = self.tip_s + turned(q, self.foot)
        torque = np.cross(self.com, own) + np.cross(lever, felt) - self.inertia * rate(spin) - np.cross(spin, self.inertia * spin)
        return own + felt + self.bias, torque + self.torque_bias

    def write(self, folder):
        r, kind, t = self.rng, self.kind, self.t
        size, side = self.size, self.side
        save = lambda name, head, rows: np.savetxt(os.path.join(folder, name), rows, '%.9f', ',', header=head, comments='')
        f, m = self.wrench()
        f, m = f[::4], m[::4]
        s = t[::4]
        f = f + np.cumsum(r.normal(0, 1e-4, f.shape), 0) + r.normal(0, .01, f.shape)
        m = m + r.normal(0, 2e-4, m.shape)
        late = {'knock early': .6, 'knock late': (self.begin + self.end) / 2}.get(kind)
        if late:
            f = f + (s > late)[:, None] * (.2 + .6 * size) * side
        if kind == 'drift':
            f = f + (s / s[-1])[:, None] * (.2 + .6 * size) * side
        gain = np.ones(3)
        if kind in ('gain', 'later gain'):
            gain[r.integers(3)] += (.1 + .2 * size) * (1 if r.random() < .5 else -1)
        f = f * gain
        stamps = s * (1 + self.skew) + self.offset
        if kind == 'clock':
            stamps = stamps + (s > self.begin + .5 * (self.end - self.begin)) * (.03 + .3 * size)
        keep = np.ones(len(s), bool)
        if kind == 'packets':
            keep = r.random(len(s)) > .05 + .1 * size
            keep[int(1000 * self.begin) + 5000:][:int(100 + 400 * size)] = False
        save('force.csv', 't_s,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm', np.column_stack([stamps, f, m])[keep])
        at = np.arange(0, t[-1], 1 / self.frames)
        q = np.stack([np.interp(at, t, self.q_ws[:, k]) for k in range(4)], -1)
        q /= np.linalg.norm(q, axis=-1, keepdims=True)
        c = np.stack([np.interp(at, t, self.center[:, k]) for k in range(3)], -1)
        q_tp = product(product(self.q_tw, q), inverse(self.q_ps))
        p = self.in_tracker(at, c) - turned(q_tp, self.tip_p) + r.normal(0, 8e-5, c.shape)
        q_tp = product(rotation(r.normal(0, 8e-4, c.shape)), q_tp)
        for first in range(int(self.frames * 3), len(at), int(self.frames * 4)):
            run = slice(first, first + max(2, int(self.frames * (.02 + .3 * size))))
            if kind == 'frozen':
                p[run], q_tp[run] = p[first - 1], q_tp[first - 1]
            if kind == 'swapped':
                p[run] += (.005 + .025 * size) * side
        if kind == 'scale':
            p = p * (1 + .01 + .02 * size)
        save('motion.csv', 't_s,x_m,y_m,z_m,qw,qx,qy,qz', np.column_stack([at, p, q_tp]))
        turns = rotation(np.stack([self.direction() * r.uniform(0, np.pi) for _ in range(r.integers(9, 16))]))
        weight = turned(inverse(turns), self.mass * G)
        gain = np.ones(3) if kind == 'later gain' else gain
        rows = np.column_stack([(weight + self.bias) * gain, np.cross(self.com, weight) + self.torque_bias])
        rows = rows + r.normal(0, 1, rows.shape) * np.array([3e-3] * 3 + [6e-5] * 3)
        save('statics.csv', 'fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm,qw,qx,qy,qz',
             np.column_stack([-rows if kind == 'statics' else rows, turns]))
        marks = r.uniform(-.1, .1, (r.integers(5, 8), 3)) * [1, 1, .3] + [*self.middle, 0]
        seen = turned(self.q_tw, marks) + self.origin + r.normal(0, 1.5e-4, marks.shape)
        save('markers.csv', 'x_m,y_m,z_m,mx_m,my_m,mz_m', np.column_stack([seen * (1.01 + .02 * size if kind == 'scale' else 1), marks]))
        self.write_mesh(folder)
        self.describe(folder)

    def write_mesh(self, folder):
        n, reach = 140, .9 * self.sizes[1] if self.surface == 'torus' else .055
        x, y = np.meshgrid(np.linspace(-reach, reach, n) + self.middle[0], np.linspace(-reach, reach, n) + self.middle[1])
        corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel() + 1
        faces = np.concatenate([np.stack([corner, corner + 1, corner + n + 1], -1), np.stack([corner, corner + n + 1, corner + n], -1)])
        with open(os.path.join(folder, 'object.obj'), 'w') as out:
            np.savetxt(out, 1e3 * np.stack([x.ravel(), y.ravel(), self.height(x, y)[0].ravel()], -1), 'v %.5f %.5f %.5f')
            np.savetxt(out, faces, 'f %d %d %d')

    def describe(self, folder):
        tip, tip_s, q_ps, ball = self.tip_p, self.tip_s, self.q_ps, self.ball
        if self.kind == 'tip':
            tip = tip + (2e-3 + 5e-3 * self.size) * self.side
        if self.kind == 'lever':
            tip_s = tip_s + (5e-3 + 1e-2 * self.size) * self.side
        if self.kind == 'frame':
            q_ps = product(q_ps, rotation((.08 + .15 * self.size) * self.side))
        if self.kind == 'radius':
            ball = ball + 1e-3 + 1e-3 * self.size
        numbers = lambda v: '[' + ', '.join('%.12f' % x for x in v) + ']'
        tap = self.normal(self.middle[:1], self.middle[1:])[0]
        with open(os.path.join(folder, 'acquisition.json'), 'w') as out:
            out.write('{"schema": "touchstone-acquisition/1", "force": {"file": "force.csv", "cutoff_Hz": 20},\n'
                      '"motion": {"file": "motion.csv", "keep_around_gaps": %s}, "probe": {"tip_P_m": %s, "tip_S_m": %s, "q_PS": %s, "tip_radius_m": %.9f},\n'
                      '"tool": {"file": "statics.csv", "gravity_T_m_per_s2": [0, 0, -9.81]}, "clocks": {"tap_normal_W": %s},\n'
                      '"registration": {"markers": "markers.csv", "mesh": "object.obj", "mesh_unit": "mm", "contact_force_N": 0.4}}\n'
                      % ('true' if self.keeps else 'false', numbers(tip), numbers(tip_s), numbers(q_ps), ball, numbers(tap)))

    def smoothed(self, values):
        """By a Gaussian of 20 Hz (-3 dB)."""
        gauss = np.exp(-.5 * (np.fft.rfftfreq(len(self.t), 1 / RATE) / 20)**2 * np.log(2))
        return np.fft.irfft(np.fft.rfft(values, axis=0) * gauss[:, None], len(self.t), axis=0)

    def errors(self, recording):
        """Place [m], root mean square and worst, and force [N] and its limit, while it scans."""
        rows = np.genfromtxt(recording, delimiter=',', names=True)
        at = rows['t_s']
        scans = (at > self.begin + 1) & (at < self.end - 1)
        columns = lambda names: np.stack([rows[n][scans] for n in names], -1)
        true = lambda a: np.stack([np.interp(at[scans], self.t, a[:, k]) for k in range(3)], -1)
        off = np.linalg.norm(columns(('x_m', 'y_m', 'z_m')) - true(self.center), axis=-1)
        force = true(self.smoothed(self.force + self.inertial))
        wrong = np.linalg.norm(columns(('fx_N', 'fy_N', 'fz_N')) - force, axis=-1)
        rms = lambda a: np.sqrt(np.mean(a**2))
        return rms(off), off.max(), rms(wrong), max(.1, .03 * rms(np.linalg.norm(force, axis=-1)))


def main(program, first, count, what, only=None):
    refused, wrong = 0, 0
    for i in range(count):
        kind = (only or KINDS[i % len(KINDS)]) if what == 'disturbed' else 'none'
        session = Session(first + i, kind)
        with tempfile.TemporaryDirectory() as folder:
            session.write(folder)
            out = os.path.join(folder, 'recording.csv')
            run = subprocess.run([program, 'acquire', 'run', os.path.join(folder, 'acquisition.json'), '--out', out],
                                 capture_output=True, text=True)
            said = (run.stderr + ' '.join(l for l in run.stdout.splitlines() if l.startswith('note'))).replace('\n', ' ')
            if run.returncode not in (0, 1, 3):
                sys.exit('exit status %d: %s' % (run.returncode, said))
            verdict, figures = 'refused', ''
            if run.returncode == 0:
                place, worst, force, limit = session.errors(out)
                right = place < 1e-3 and worst < 3e-3 and force < limit
                verdict = 'right' if right else 'WRONG'
                if not right and session.move_is_hidden() and 'by any distance along' in said:
                    verdict = 'said'
                figures = '%.2f mm, worst %.2f mm, %.3f N of %.3f;' % (1e3 * place, 1e3 * worst, force, limit)
            refused += verdict == 'refused'
            wrong += verdict == 'WRONG'
            print(first + i, kind, session.surface, verdict, figures, said[:int(os.environ.get('SAID', 230))], flush=True)
    print('%d sessions from seed %d: %d refused, %d silently wrong' % (count, first, refused, wrong))
    return wrong > 0 or (what == 'undisturbed' and refused > .02 * count)


if __name__ == '__main__':
    sys.exit(main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), *sys.argv[4:]))
