#!/usr/bin/env python3
"""Recordings with a hidden cause from a simulator that shares no code with the project, and what the search makes of them.

    foreign_recordings.py TOUCHSTONE SEED COUNT [--keep FOLDER] [--only KIND] [--held] [--limit SECONDS] [--search-seed N]

Prints a line for each recording and a table: named, called consistent, flagged, 95 % intervals that cover, seconds.
Exit status 0; 1 if a share of LIMITS is not met beyond chance (binomial, 1 %); 77: numpy is missing.
Sources. Hand: strokes of least jerk (Flash and Hogan, J. Neuroscience 5 (1985) 1688) with tremor of 8 to 12 Hz (Elble and
Koller, Tremor, Johns Hopkins 1990). Objects: superellipsoid (Barr, IEEE CG&A 1 (1981) 11), egg crate, torus; the tip's
foot by Newton's method on the closed form. Noise: tracker AR(2) (Box and Jenkins 1970, 3.2.4), force white on 1/f
(Voss and Clarke, J. Acoust. Soc. Am. 63 (1978) 258) and rounded.
Causes: bristles of Dahl (1968) and LuGre (Canudas de Wit et al., IEEE TAC 40 (1995) 419); ageing by Ruina's slip law (J.
Geophys. Res. 88 (1983) 10359) with the regularised rate (Lapusta et al., J. Geophys. Res. 105 (2000) 23765); load exponent
(Bowden and Tabor 1950); hereditary integral of a Prony arm (Christensen, Theory of Viscoelasticity, 1.2); Kelvin and
Voigt; Hunt and Crossley (1975); Dugdale's bond (Maugis, J. Colloid Interface Sci. 150 (1992) 243); Hertz.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
import time

try:
    import numpy as np
except ImportError:
    sys.exit(77)

STEP, KEPT = 1e-3, 4  # simulated [s]; every fourth is recorded
ONE = ('coulomb-friction', 'stribeck-friction', 'sublinear-friction', 'stress-relaxation', 'normal-damping', 'hunt-crossley',
       'power-law-stiffness', 'time-lag', 'force-bias', 'force-drift', 'force-crosstalk', 'viscous-friction', 'registration',
       'adhesion', 'ageing-friction', 'tracker-scale', 'two-materials', 'gain-drift')
TWO = (('coulomb-friction', 'stress-relaxation'), ('force-crosstalk', 'normal-damping'), ('time-lag', 'coulomb-friction'),
       ('force-bias', 'hunt-crossley'), ('gain-drift', 'coulomb-friction'), ('two-materials', 'force-crosstalk'),
       ('viscous-friction', 'stress-relaxation'), ('power-law-stiffness', 'force-drift'))
HELD = ('stress-relaxation', 'force-drift')  # of one press that is held to the end, over which they are much the same
UNKNOWN = ('plastic', 'hum', 'second-layer', 'suction', 'grain')
STUDENT_9 = {50: .7027, 68: 1.0526, 80: 1.3830, 90: 1.8331, 95: 2.2622, 99: 3.2498}  # two-sided quantiles, 9 degrees of freedom
LIMITS = {'one named first': .9, 'nothing missing: not named': .95, 'unknown: flagged': .95, 'intervals that cover': .93}


def least_jerk(u):
    u = np.clip(u, 0, 1)
    return u**3 * (10 - 15 * u + 6 * u**2)


class Surface:
    """z = h(x, y), inside below."""

    def __init__(self, rng, size):
        self.kind, self.size, u = ('superellipsoid', 'egg crate', 'torus')[rng.integers(3)], size, rng.uniform
        self.a = size * u(2.2, 3.5, 2)
        self.power, self.c = u(2., 2.6), size * u(.7, 1.1)
        self.wave = 2 * np.pi / (size * u(1.8, 2.8, 2))
        self.phase, self.crest = u(0, 6, 2), size * u(.025, .05)
        self.tube, self.ring = size * u(2., 3.), size * u(2.5, 4.)

    def height(self, x, y):
        if self.kind == 'superellipsoid':
            rest = 1 - (np.abs(x / self.a[0])**2 + np.abs(y / self.a[1])**2)**(self.power / 2)
            return self.c * (np.maximum(rest, 1e-3)**(1 / self.power) - 1)
        if self.kind == 'egg crate':
            return self.crest * np.sin(self.wave[0] * x + self.phase[0]) * np.sin(self.wave[1] * y + self.phase[1])
        across = np.hypot(x + self.ring, y) - self.ring  # at the tube's crest, off its middle
        return np.sqrt(np.maximum(self.tube**2 - across**2, 1e-9)) - self.tube

    def slopes(self, x, y, e=1e-6):
        h = self.height
        return (h(x + e, y) - h(x - e, y)) / (2 * e), (h(x, y + e) - h(x, y - e)) / (2 * e)

    def normal(self, x, y):
        gx, gy = self.slopes(x, y)
        n = np.stack([-gx, -gy, np.ones_like(gx)], -1)
        return n / np.linalg.norm(n, axis=-1, keepdims=True)

    def foot(self, p, x, y):
        """The nearest point by Newton's method from a guess."""
        for _ in range(12):
            h, (gx, gy) = self.height(x, y), self.slopes(x, y)
            e = 1e-5
            ax, ay = self.slopes(x + e, y), self.slopes(x, y + e)
            r = h - p[:, 2]
            fx, fy = x - p[:, 0] + r * gx, y - p[:, 1] + r * gy
            xx, yy = 1 + gx * gx + r * (ax[0] - gx) / e, 1 + gy * gy + r * (ay[1] - gy) / e
            xy = gx * gy + r * (ax[1] - gy) / e
            d = xx * yy - xy * xy
            x, y = x - np.clip((yy * fx - xy * fy) / d, -1e-3, 1e-3), y - np.clip((xx * fy - xy * fx) / d, -1e-3, 1e-3)
        return x, y

    def write(self, path, off, cells=64):
        side = np.linspace(-1.45 * self.size, 1.45 * self.size, cells + 1)
        x, y = np.meshgrid(side, side)
        z, low = self.height(x, y), -.3 * self.size + self.height(x, y).min()
        points = np.concatenate([np.stack([x, y, z], -1).reshape(-1, 3), np.stack([x, y, low + 0 * z], -1).reshape(-1, 3)]) + off
        at, n, quads = lambda i, j: i * (cells + 1) + j, (cells + 1)**2, []
        for i in range(cells):
            for j in range(cells):
                q = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]
                if (i + j) % 2:
                    q = q[1:] + q[:1]  # diagonals alternate
                quads += [q, [n + k for k in reversed(q)]]
            for a, b in ((at(0, i + 1), at(0, i)), (at(cells, i), at(cells, i + 1)), (at(i, 0), at(i + 1, 0)),
                         (at(i + 1, cells), at(i, cells))):
                quads.append([a, b, n + b, n + a])
        with open(path, 'w') as out:
            out.writelines('v %.9f %.9f %.9f\n' % tuple(p) for p in points)
            for a, b, c, d in quads:
                out.write('f %d %d %d\nf %d %d %d\n' % (a + 1, b + 1, c + 1, a + 1, c + 1, d + 1))
        middle = np.meshgrid(*[(side[1:] + side[:-1]) / 2] * 2)
        return float(np.abs(self.height(*middle) - (z[1:, 1:] + z[:-1, :-1]) / 2).max())


def relaxed(step, gain, x):
    """y' = (x - y) gain, sample by sample, exact for a constant x over a step."""
    y, out, keep = 0.0, np.empty(len(x)), np.exp(-gain * step)
    for i, v in enumerate(x.tolist()):
        y = v + (y - v) * keep
        out[i] = y
    return out


class Case:
    def __init__(self, seed, only=None, held=False):
        self.rng, self.held = np.random.default_rng([seed, 20260350]), held
        r = self.rng
        u, turn = r.uniform, seed % 60
        self.set = 'one' if turn < 27 else 'two' if turn < 39 else 'none' if turn < 51 else 'unknown'
        self.hidden = {'one': (ONE[turn % len(ONE)],), 'two': TWO[turn % len(TWO)], 'none': (),
                       'unknown': (UNKNOWN[turn % len(UNKNOWN)],)}[self.set]
        if held:
            self.set, self.hidden = 'held', (HELD[turn % len(HELD)],)
        if only:
            self.set, self.hidden = ('unknown' if only in UNKNOWN else 'one'), (only,)
        self.stiffness = np.exp(u(np.log(300), np.log(1800)))
        self.depth = min(u(2.5, 4.5) / self.stiffness, .012)
        self.force = self.depth * self.stiffness
        self.size = self.depth * u(6.5, 10)
        self.surface = Surface(r, self.size)
        fine = seed % 2
        self.sigma_p, self.sigma_f = min(2e-4, (.01 if fine else .02) * self.depth), u(.008, .012) if fine else u(.012, .025)
        self.rate = (60., 100., 120.)[r.integers(3)]
        # What the maker declares is about right, and the colours are this case's own.
        self.low_pass, self.pink, self.declared = u(.35, .8), u(.02, .1), u(.85, 1.2, 2)
        self.truth = {}
        sign = lambda: 1 if u() < .5 else -1
        F, D, V = self.force, self.depth, self.size / 1.2
        way = u(1e-5, 3e-5) * min(1, D / .004)
        size = {
            'coulomb-friction': lambda: {'mu_dynamic': u(.2, .6), 'way': way},
            'stribeck-friction': lambda: {'mu_dynamic': u(.15, .3), 'mu_static': u(.45, .7), 'stribeck_velocity_m_per_s': u(.2, .5) * V, 'way': way},
            'sublinear-friction': lambda: {'mu': u(.25, .5), 'exponent': u(.6, .75), 'way': way},
            'ageing-friction': lambda: {'mu': u(.25, .4), 'rate': u(.005, .01), 'age': u(.05, .08), 'length': u(.03, .1) * self.size, 'way': way},
            'stress-relaxation': lambda: {'ratio': u(.25, .8), 'time_constant_s': np.exp(u(np.log(.1), np.log(1.5)))},
            'normal-damping': lambda: {'coefficient_N_s_per_m': u(.15, .4) * F * .4 / D},
            'hunt-crossley': lambda: {'coefficient_N_s_per_m2': u(.3, .8) * F * .4 / D**2},
            'power-law-stiffness': lambda: {'exponent': u(1.25, 1.8)},
            'viscous-friction': lambda: {'coefficient_N_s_per_m': u(.15, .4) * F / V},
            'time-lag': lambda: {'lag_s': u(.008, .03)},
            'force-bias': lambda: dict(zip(('fx_N', 'fy_N', 'fz_N'), F * u(.06, .2, 3) * r.choice([-1, 1], 3))),
            'force-drift': lambda: dict(zip(('fx_N_per_s', 'fy_N_per_s', 'fz_N_per_s'), F / 20 * u(.1, .4, 3) * r.choice([-1, 1], 3))),
            'force-crosstalk': lambda: {'c_xz': sign() * u(.05, .2), 'c_yz': sign() * u(.05, .2)},
            'registration': lambda: dict(zip(('dx_m', 'dy_m', 'dz_m'), D * np.array([.5, .5, .15]) * u(.4, 1, 3) * r.choice([-1, 1], 3))),
            'adhesion': lambda: {'pull': F * u(.15, .3), 'reach': D * u(.15, .3)},
            'tracker-scale': lambda: {'scale': sign() * u(.02, .05)},
            'two-materials': lambda: {'step': np.exp(sign() * u(.4, .9)), 'angle': u(0, np.pi), 'border': u(-.25, .25) * self.size},
            'gain-drift': lambda: {'rate_per_s': sign() * u(.006, .02)},
            'plastic': lambda: {'share': u(.25, .45)},
            'hum': lambda: {'size': F * u(.08, .15), 'Hz': u(6, 11)},
            'second-layer': lambda: {'from': D * u(.4, .5), 'ratio': u(2., 3.)},
            'suction': lambda: {'size': F * u(.3, .5), 'tau': u(.1, .3)},
            'grain': lambda: {'tilt': u(.25, .45), 'wave': self.size * u(.25, .4)},
        }
        for name in self.hidden:
            self.truth[name] = size[name]()
        self.seconds = (17, 22), (14, 18)
        if held:
            self.seconds = ((4, 6),) * 2
            self.truth = {HELD[0]: {'ratio': u(.25, .8), 'time_constant_s': u(3, 12)},
                          HELD[1]: {'fx_N_per_s': 0., 'fy_N_per_s': 0., 'fz_N_per_s': F * u(-.06, -.02)}}
            self.truth = {name: self.truth[name] for name in self.hidden}

    def path(self, seconds, pace, load):
        """Foot (x, y) and depth, by strokes of least jerk."""
        u, t = self.rng.uniform, np.arange(0, seconds, STEP)
        out = np.zeros((3, len(t)))
        here, at = np.array([*u(-.5, .5, 2) * self.size, (-.02 if self.held else -1.5) * self.depth]), .3
        out[:] = here[:, None]
        kinds = ['press'] if self.held else ['press', 'slide', 'slide', 'tap', 'hold', 'slide']
        while at < seconds:
            kind = kinds[self.rng.integers(len(kinds))]
            there, time_s = here.copy(), pace * u(.35, 1.0)
            if kind == 'slide':
                there[:2], time_s = u(-.8, .8, 2) * self.size, pace * u(.6, 1.6)
            if kind in ('press', 'slide'):
                there[2] = load * self.depth * u(.25, 1.)
            if kind == 'tap':
                there[2], time_s = -u(.3, 1.5) * self.depth, pace * u(.2, .5)
            step = least_jerk((t - at) / time_s)
            out += (there - here)[:, None] * step
            here, at = there, seconds if self.held else at + time_s * u(.9, 1.15)
        band = np.fft.rfftfreq(len(t), STEP)
        for k, size in enumerate((6e-5, 6e-5, .015 * self.depth)):
            shake = np.fft.irfft(np.fft.rfft(self.rng.normal(size=len(t))) * np.exp(-.5 * (band - 10)**2), len(t))
            out[k] += u(.3, 1.) * size * shake / shake.std()
        return t, out

    def bristle(self, slip, way, level):
        """Bristle of unit strength dragged by the slip; `level`: its limit (of 1) at each step."""
        z, out = [0.0, 0.0, 0.0], np.empty_like(slip)
        for i, ((a, b, c), g) in enumerate(zip(slip.tolist(), level.tolist())):
            s = (a * a + b * b + c * c)**.5
            if s > 0:
                keep = np.exp(-s / (way * g))
                z = [z[0] * keep + a / s * g * (1 - keep), z[1] * keep + b / s * g * (1 - keep), z[2] * keep + c / s * g * (1 - keep)]
            out[i] = z
        return -out

    def forces(self, t, p, x, y):
        s, T = self.surface, self.truth
        n, foot = s.normal(x, y), np.stack([x, y, s.height(x, y)], -1)
        d = np.sum((foot - p) * n, -1)
        touch, deep = d > 0, np.maximum(d, 0)
        k = np.full(len(t), self.stiffness)
        if 'two-materials' in T:
            q = T['two-materials']
            k *= np.where(x * np.cos(q['angle']) + y * np.sin(q['angle']) > q['border'], q['step'], 1.)
        rate = np.gradient(d, STEP)
        N = k * deep
        if 'power-law-stiffness' in T:
            N = k * self.depth * (deep / self.depth)**T['power-law-stiffness']['exponent']
        if 'second-layer' in T:
            N = N + (T['second-layer']['ratio']) * k * np.maximum(d - T['second-layer']['from'], 0)
        if 'plastic' in T:
            N = k * np.maximum(d - T['plastic']['share'] * np.maximum.accumulate(deep), 0)
        if 'stress-relaxation' in T:
            q = T['stress-relaxation']
            N = np.where(touch, N + q['ratio'] * (N - relaxed(STEP, 1 / q['time_constant_s'], N)), 0)
        if 'normal-damping' in T:
            N = N + touch * T['normal-damping']['coefficient_N_s_per_m'] * rate
        if 'hunt-crossley' in T:
            N = N + T['hunt-crossley']['coefficient_N_s_per_m2'] * deep * rate
        N = np.maximum(N, 0)
        pull = np.zeros(len(t))
        if 'adhesion' in T:
            q, bonded = T['adhesion'], False
            for i, gap in enumerate((-d).tolist()):
                bonded = gap < q['reach'] and (bonded or gap < 0)
                pull[i] = q['pull'] * bonded
        if 'suction' in T:
            pull = T['suction']['size'] * relaxed(STEP, 1 / T['suction']['tau'], touch * 1.) * touch
        step = np.diff(p, axis=0, prepend=p[:1])
        slip = (step - n * np.sum(step * n, -1, keepdims=True)) * touch[:, None]
        speed = np.linalg.norm(slip, axis=-1) / STEP
        f = (N - pull)[:, None] * n
        one = np.ones(len(t))
        if 'coulomb-friction' in T:
            q = T['coulomb-friction']
            f = f + q['mu_dynamic'] * N[:, None] * self.bristle(slip, q['way'], one)
        if 'stribeck-friction' in T:
            q = T['stribeck-friction']
            g = q['mu_dynamic'] + (q['mu_static'] - q['mu_dynamic']) * np.exp(-(speed / q['stribeck_velocity_m_per_s'])**2)
            f = f + N[:, None] * self.bristle(slip, q['way'] / q['mu_static'], g)
        if 'sublinear-friction' in T:
            q = T['sublinear-friction']
            f = f + (q['mu'] * self.force * (N / self.force)**q['exponent'])[:, None] * self.bristle(slip, q['way'], one)
        if 'ageing-friction' in T:
            q, v0 = T['ageing-friction'], self.size / 2
            old, g = 0.0, np.empty(len(t))
            for i, v in enumerate(speed.tolist()):  # Ruina's slip law; log of state, and the regularised rate
                w = max(v, 1e-3 * v0)
                old += (1 - np.exp(-w * STEP / q['length'])) * (-np.log(w / v0) - old)
                g[i] = q['rate'] * np.arcsinh(w / (2 * v0) * np.exp((q['mu'] + q['age'] * old) / q['rate']))
            f = f + N[:, None] * self.bristle(slip, q['way'], g)
        if 'grain' in T:  # pulls along the surface by the place, whichever way the tip goes
            q = T['grain']
            f = f + (q['tilt'] * N * np.sin(2 * np.pi * x / q['wave']))[:, None] * (np.array([1., 0, 0]) - n * n[:, :1])
        if 'viscous-friction' in T:
            f = f - T['viscous-friction']['coefficient_N_s_per_m'] * slip / STEP
        if 'force-crosstalk' in T:
            f = f + f[:, 2:] * np.array([T['force-crosstalk']['c_xz'], T['force-crosstalk']['c_yz'], 0])
        if 'gain-drift' in T:
            f = f * (1 + T['gain-drift']['rate_per_s'] * t)[:, None]
        for name, grow in (('force-bias', one), ('force-drift', t)):
            if name in T:
                f = f + grow[:, None] * np.array(list(T[name].values()))
        if 'hum' in T:
            f = f + (T['hum']['size'] * np.sin(2 * np.pi * T['hum']['Hz'] * t))[:, None] * np.array([.6, .64, .48])
        if 'time-lag' in T:
            f = np.stack([np.interp(t - T['time-lag']['lag_s'], t, f[:, i]) for i in range(3)], -1)
        return f

    def record(self, path, seconds, pace, load):
        r, (t, (x, y, d)) = self.rng, self.path(seconds, pace, load)
        p = np.stack([x, y, self.surface.height(x, y)], -1) - d[:, None] * self.surface.normal(x, y)
        x, y = self.surface.foot(p, x, y)
        f = self.forces(t, p, x, y)
        s = t[::KEPT]
        frames = np.arange(0, seconds + .1, 1 / self.rate)
        e, a, b = r.normal(size=(len(frames) + 50, 3)), self.low_pass, -.25
        for i in range(2, len(e)):
            e[i] += a * e[i - 1] + b * e[i - 2]
        seen = p * (1 + self.truth.get('tracker-scale', {'scale': 0})['scale'])
        e = self.sigma_p * (1 - a - b) * e[50:]  # white noise of sigma_p through a low-pass of gain 1
        m = np.stack([np.interp(s, frames, np.interp(frames, t, seen[:, i]) + e[:, i]) for i in range(3)], -1)
        f = f[::KEPT]
        pink = sum(np.repeat(r.normal(size=(len(s) // 2**o + 2, 3)), 2**o, 0)[r.integers(2**o):][:len(s)] for o in range(4, 13))
        f = f + r.normal(0, self.sigma_f, f.shape) + self.pink * self.sigma_f * pink
        f = np.round(f / 2e-3) * 2e-3
        np.savetxt(path, np.column_stack([s, m, f]), '%.6f', ',', header='t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N', comments='')

    def write(self, folder):
        off = np.zeros(3)
        if 'registration' in self.truth:  # measured = true + d: the mesh stands d before what was touched
            off = -np.array(list(self.truth['registration'].values()))
        error = self.surface.write(os.path.join(folder, 'mesh.obj'), off)
        self.record(os.path.join(folder, 'train.csv'), self.rng.uniform(*self.seconds[0]), 1., 1.)
        self.record(os.path.join(folder, 'holdout.csv'), self.rng.uniform(*self.seconds[1]), self.rng.uniform(.8, 1.3), self.rng.uniform(.75, .95))
        save = lambda name, value: json.dump(value, open(os.path.join(folder, name), 'w'), indent=1)
        save('model.json', {'schema': 'touchstone-model/1', 'renderer': 'god-object',
                            'parameters': {'stiffness_N_per_m': round(self.stiffness * self.rng.uniform(.9, 1.1), 2)}, 'effects': [], 'instrument': []})
        save('instrument.json', {'schema': 'touchstone-instrument/1', 'force_noise_N': self.sigma_f * self.declared[0], 'force_step_N': [2e-3] * 3,
                                 'position_noise_m': self.sigma_p * self.declared[1], 'position_rate_Hz': self.rate, 'geometry_error_m': max(1.2 * error, 1e-6)})
        save('truth.json', {'set': self.set, 'hidden': self.truth, 'stiffness': self.stiffness, 'surface': self.surface.kind})


def search(program, case, folder, limit, seed):
    begin = time.time()
    run = subprocess.run([program, 'discrepancy', '--seed', str(seed), '--time-limit', str(limit), '--out', os.path.join(folder, 'out')] +
                         sum(([o, os.path.join(folder, f)] for o, f in (('--model', 'model.json'), ('--mesh', 'mesh.obj'),
                             ('--recording', 'train.csv'), ('--holdout', 'holdout.csv'), ('--instrument', 'instrument.json'))), []),
                         capture_output=True, text=True)
    seconds = time.time() - begin
    try:
        found = json.load(open(os.path.join(folder, 'out', 'findings.json')))
    except OSError:
        sys.exit('exit status %d: %s' % (run.returncode, run.stderr))
    covers = []
    for effect in found['effects']:
        for p in effect['parameters']:
            true = case.truth.get(effect['name'], {}).get(p['name'])
            if true is not None:
                low, high = p['interval95'] or (None, None)  # null: open
                low, high = -np.inf if low is None else low, np.inf if high is None else high
                covers.append((effect['name'] + '/' + p['name'], low <= true <= high, true, p['value'], low, high))
    return {'names': [e['name'] for e in found['effects']], 'verdict': found['verdict'], 'code': found['code'], 'seconds': seconds,
            'groups': found['ambiguous'], 'covers': covers, 'gap': found['gap']['holdout'], 'noise': found['gap']['noise_floor']}


def table(rows):
    share = lambda yes: '%d of %d' % (sum(yes), len(yes)) if yes else '-'
    of = lambda name: [(c, r) for c, r in rows if c.set == name]
    named = lambda c, r: set(c.hidden) <= set(r['names'])
    rates = {}

    def say(title, yes):
        print('%-44s %s' % (title, share(yes)))
        if yes:
            rates[title] = sum(yes), len(yes)
    say('one named first', [r['names'][:1] == list(c.hidden) for c, r in of('one')])
    say('one named alone', [set(r['names']) == set(c.hidden) for c, r in of('one')])
    say('two: both named', [named(c, r) for c, r in of('two')])
    say('nothing missing: not named', [not r['names'] for c, r in of('none')])
    say('nothing missing: called consistent', [r['verdict'] == 'consistent' for c, r in of('none')])
    say('unknown: flagged', [r['verdict'] in ('unexplained', 'not-identifiable') for c, r in of('unknown')])
    say('right names alone, yet called unexplained', [r['verdict'] == 'unexplained' for c, r in rows
                                                      if c.hidden and c.set != 'unknown' and set(r['names']) == set(c.hidden)])
    alias = lambda c, r: named(c, r) or any(set(c.hidden) <= set(group) for group in r['groups'])
    say('held: right, or cannot tell with it', [alias(c, r) and (named(c, r) or r['verdict'] == 'not-identifiable') for c, r in of('held')])
    say('held: explained by another', [r['verdict'] == 'explained' and not named(c, r) for c, r in of('held')])
    covers = [one for c, r in rows for one in r['covers']]
    say('intervals that cover', [one[1] for one in covers])
    for family in sorted({one[0] for one in covers}):
        print('    %-40s %s' % (family, share([one[1] for one in covers if one[0] == family])))
    # Each interval as it would be at another level: its two halves by Student's t of ten simulated recordings.
    closed = [(abs(true - value) / max(1e-300, high - value if true > value else value - low))
              for _, _, true, value, low, high in covers if np.isfinite(high - low)]
    print('    of %d closed intervals at the level of %s' % (len(closed), ', '.join(
        '%d %%: %.0f %%' % (level, 100 * np.mean(np.array(closed) <= t / STUDENT_9[95])) for level, t in STUDENT_9.items()) if closed else '-'))
    s = np.array([r['seconds'] for c, r in rows])
    print('seconds: median %.1f, 95 %% %.1f, most %.1f' % (np.median(s), np.percentile(s, 95), s.max()))
    return rates


def main():
    arguments = argparse.ArgumentParser()
    for name, kind in (('program', str), ('seed', int), ('count', int)):
        arguments.add_argument(name, type=kind)
    for name, kind, default in (('--keep', str, None), ('--only', str, None), ('--limit', float, 60.), ('--search-seed', int, 1)):
        arguments.add_argument(name, type=kind, default=default)
    arguments.add_argument('--held', action='store_true')
    asked = arguments.parse_args()

    def one(seed):
        case = Case(seed, asked.only, asked.held)
        with tempfile.TemporaryDirectory() as folder:
            folder = folder if not asked.keep else os.path.join(asked.keep, str(seed))
            os.makedirs(folder, exist_ok=True)
            case.write(folder)
            row = search(asked.program, case, folder, asked.limit, asked.search_seed)
        missed = ['%s %.4g [%.4g, %.4g] for %.4g' % (n, v, l, h, true) for n, inside, true, v, l, h in row['covers'] if not inside]
        print(seed, case.set, '+'.join(case.hidden) or '-', case.surface.kind, row['verdict'], row['code'], row['names'], row['groups'] or '',
              'N %.3g -> %.3g (%.3g)' % (row['gap']['before'], row['gap']['after'], row['noise']), '%.1f s' % row['seconds'], *missed,
              sep=' | ', flush=True)
        return case, row
    rates = table([one(seed) for seed in range(asked.seed, asked.seed + asked.count)])

    def by_chance(share, of, least):
        return sum(math.comb(of, k) * least**k * (1 - least)**(of - k) for k in range(share + 1))
    return any(by_chance(*rates[title], least) < .01 for title, least in LIMITS.items() if title in rates)


if __name__ == '__main__':
    sys.exit(main())
