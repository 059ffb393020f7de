# A session in a laboratory, as its instruments would have written it, for the tutorial "A lab day": a probe with a force
# sensor taps three times on a steel washer that lies flush in a soft plate, strokes the plate and taps again, while a
# tracker watches.
#   awk -v folder=session -f make_session.awk
# What is true: the plate is z = 0 of the object's frame W and pushes back with 800 N/m and a friction coefficient of 0.2;
# the tool on the sensor weighs 30 g; the sensor's clock is 0.4137 s ahead of the tracker's. The noise is 5 mN and 20 um.
BEGIN {
  if (folder == "") folder = "."
  pi = atan2(0, -1)
  mass = 0.030; centre_z = 0.024                    # of the tool, in the sensor's frame S
  bias_x = 0.4; bias_y = -0.2; bias_z = 1.1         # N
  tip_z = 0.05                                      # the tip in S, which is the tracked body's frame, too
  yaw = pi / 6; at_x = 0.10; at_y = -0.05; at_z = 0.40  # the object in the tracker's frame T
  ahead_s = 0.4137; mu = 0.2; stiffness = 800
  taps = split("1.0 1.7 2.45 16.1 16.9 17.5", tap, " ")
  state = 20060325                                  # of Park and Miller's generator, the same in every awk

  out = folder "/force.csv"
  print "t_s,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm" > out
  for (i = 0; i <= 19000; ++i) {
    t = i / 1000
    attitude(t); force(t)
    wrench(fx, fy, fz)
    printf "%.6f,%.6f,%.6f,%.6f,%.7f,%.7f,%.7f\n", t + ahead_s, wx + 0.005 * noise(), wy + 0.005 * noise(), wz + 0.005 * noise(), mx, my, mz > out
  }
  close(out)

  out = folder "/motion.csv"
  print "t_s,x_m,y_m,z_m,qw,qx,qy,qz" > out
  for (i = 0; i <= 19 * 120; ++i) {
    t = i / 120
    attitude(t); tip(t)
    turn(qw, qx, qy, qz, 0, 0, tip_z)               # from the body's origin to the tip
    x = at_x + cos(yaw) * px - sin(yaw) * py - vx; y = at_y + sin(yaw) * px + cos(yaw) * py - vy; z = at_z + pz - vz
    printf "%.6f,%.7f,%.7f,%.7f,%.9f,%.9f,%.9f,%.9f\n", t, x + 2e-5 * noise(), y + 2e-5 * noise(), z + 2e-5 * noise(), qw, qx, qy, qz > out
  }
  close(out)

  # The tool at rest in eight orientations.
  out = folder "/statics.csv"
  print "fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm,qw,qx,qy,qz" > out
  for (i = 0; i < 8; ++i) {
    compose(cos(0.4 * i), sin(0.4 * i), 0, 0, cos(0.9 * i), 0, sin(0.9 * i), 0)
    wrench(0, 0, 0)
    printf "%.6f,%.6f,%.6f,%.7f,%.7f,%.7f,%.9f,%.9f,%.9f,%.9f\n", wx + 0.001 * noise(), wy + 0.001 * noise(), wz + 0.001 * noise(), mx, my, mz, qw, qx, qy, qz > out
  }
  close(out)

  # Four corners of the plate, as the tracker's pointer saw them and where they are on the object.
  out = folder "/markers.csv"
  print "x_m,y_m,z_m,mx_m,my_m,mz_m" > out
  marker(0.08, 0, 0); marker(-0.08, 0.05, 0.01); marker(0, -0.08, 0.03); marker(0.03, 0.07, -0.02)
  close(out)
  print "v -0.2 -0.2 0\nv 0.2 -0.2 0\nv 0.2 0.2 0\nv -0.2 0.2 0\nf 1 2 3\nf 1 3 4" > (folder "/plate.obj")
}

function marker(a, b, c) {
  printf "%.7f,%.7f,%.7f,%g,%g,%g\n", at_x + cos(yaw) * a - sin(yaw) * b + 5e-5 * noise(), at_y + sin(yaw) * a + cos(yaw) * b + 5e-5 * noise(), at_z + c + 5e-5 * noise(), a, b, c > out
}

# Standard normal, by the sum of twelve.
function noise(   sum, k) {
  for (sum = k = 0; k < 12; ++k) { state = (state * 16807) % 2147483647; sum += state / 2147483647 }
  return sum - 6
}

# (qw, qx, qy, qz) = a * b: turns S into T.
function compose(aw, ax, ay, az, bw, bx, by, bz) {
  qw = aw * bw - ax * bx - ay * by - az * bz; qx = aw * bx + ax * bw + ay * bz - az * by
  qy = aw * by - ax * bz + ay * bw + az * bx; qz = aw * bz + ax * by - ay * bx + az * bw
}

# Upside down, so that the tip points to the plate, and swinging a little.
function attitude(t,   a, b) {
  a = (pi + 0.3 * sin(0.4 * t)) / 2; b = 0.25 * cos(0.31 * t) / 2
  compose(cos(a), sin(a), 0, 0, cos(b), 0, sin(b), 0)
}

# (vx, vy, vz) = q v q^-1
function turn(w, x, y, z, a, b, c,   tx, ty, tz) {
  tx = 2 * (y * c - z * b); ty = 2 * (z * a - x * c); tz = 2 * (x * b - y * a)
  vx = a + w * tx + y * tz - z * ty; vy = b + w * ty + z * tx - x * tz; vz = c + w * tz + x * ty - y * tx
}

# How deep the tip is in the plate, above it where negative.
function depth(t,   k, d, up) {
  d = -0.012
  for (k = 1; k <= taps; ++k) {
    if (t <= tap[k]) up = 0.08 * (tap[k] - t)
    else if (t >= tap[k] + 0.09) up = 0.07 * (t - tap[k] - 0.09)
    else up = 0
    if (-up > d) d = -up
  }
  if (t > 4 && t < 14.5) {
    up = 0.012 - 0.03 * (t - 4 < 14.5 - t ? t - 4 : 14.5 - t)
    if (up < 0) { up = -0.0015 - 0.0007 * sin(2 * t); k = (t - 4.4 < 14.1 - t ? t - 4.4 : 14.1 - t) / 0.3; if (k < 1) up *= (k < 0 ? 0 : k) }
    if (-up > d) d = -up
  }
  return d
}

# The tip in W: where it was, not where the surface is.
function tip(t) { px = 0.03 * sin(0.7 * t); py = 0.03 * cos(0.7 * t); pz = -depth(t) }

# On the tip, by the plate, in W.
function force(t,   n, k) {
  n = depth(t) > 0 ? stiffness * depth(t) : 0
  for (k = 1; k <= taps; ++k) if (t > tap[k] && t < tap[k] + 0.09) n = 2 * sin(pi * (t - tap[k]) / 0.09)
  fx = -mu * n * cos(0.7 * t); fy = mu * n * sin(0.7 * t); fz = n
  if (t < 3 || t > 15) fx = fy = 0
}

# What the sensor reads, in S, for a force (a, b, c) in W on the tip: with the tool's weight and the bias.
function wrench(a, b, c,   sx, sy, sz) {
  turn(qw, -qx, -qy, -qz, cos(yaw) * a - sin(yaw) * b, sin(yaw) * a + cos(yaw) * b, c)
  sx = vx; sy = vy; sz = vz
  turn(qw, -qx, -qy, -qz, 0, 0, -9.80665 * mass)
  wx = sx + vx + bias_x; wy = sy + vy + bias_y; wz = sz + vz + bias_z
  mx = -tip_z * sy - centre_z * vy; my = tip_z * sx + centre_z * vx; mz = 0
}
