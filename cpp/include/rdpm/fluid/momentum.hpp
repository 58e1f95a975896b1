// Momentum: advection and diffusion of the staggered velocity, Adams-Bashforth 2 in time.
//
// Point functions give the tendency of one face from a window of planes; the loops walk the planes from
// bottom to top and write the new velocity over the old, behind copies of the last two old planes, so that no
// second velocity exists.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "rdpm/grid/grid.hpp"

namespace rdpm {

// Old planes k-1, k, k+1 of one velocity component.
struct Window {
    const double *below, *here, *above;
};

struct Tendency {
    double ax, ay, az;  // 1 / (4 spacing): advection of two averages
    double dx, dy, dz;  // nu / spacing^2: diffusion
    std::size_t row;

    Tendency(const Grid& g, double nu)
        : ax(0.25 / g.spacing[0]),
          ay(0.25 / g.spacing[1]),
          az(0.25 / g.spacing[2]),
          dx(nu / (g.spacing[0] * g.spacing[0])),
          dy(nu / (g.spacing[1] * g.spacing[1])),
          dz(nu / (g.spacing[2] * g.spacing[2])),
          row(g.row()) {}

    double diffusion(const Window& q, std::size_t i) const {
        const double* c = q.here + i;
        return dx * (c[1] - 2.0 * c[0] + c[-1]) + dy * (c[row] - 2.0 * c[0] + *(c - row)) +
               dz * (q.above[i] - 2.0 * c[0] + q.below[i]);
    }
    double advection_u(const Window& u, const Window& v, const Window& w, std::size_t i) const {
        const double *c = u.here + i, *s = v.here + i, *t = w.here + i, *b = w.below + i;
        const double east = c[0] + c[1], west = c[-1] + c[0];
        return -ax * (east * east - west * west) -
               ay * ((c[0] + c[row]) * (s[0] + s[1]) - (*(c - row) + c[0]) * (*(s - row) + *(s - row + 1))) -
               az * ((c[0] + u.above[i]) * (t[0] + t[1]) - (u.below[i] + c[0]) * (b[0] + b[1]));
    }
    double advection_v(const Window& u, const Window& v, const Window& w, std::size_t i) const {
        const double *c = v.here + i, *s = u.here + i, *t = w.here + i, *b = w.below + i;
        const double north = c[0] + c[row], south = *(c - row) + c[0];
        return -ax * ((c[0] + c[1]) * (s[0] + s[row]) - (c[-1] + c[0]) * (s[-1] + s[row - 1])) -
               ay * (north * north - south * south) -
               az * ((c[0] + v.above[i]) * (t[0] + t[row]) - (v.below[i] + c[0]) * (b[0] + b[row]));
    }
    double advection_w(const Window& u, const Window& v, const Window& w, std::size_t i) const {
        const double *c = w.here + i, *e = u.here + i, *ea = u.above + i, *n = v.here + i, *na = v.above + i;
        const double top = c[0] + w.above[i], bottom = w.below[i] + c[0];
        return -ax * ((c[0] + c[1]) * (e[0] + ea[0]) - (c[-1] + c[0]) * (e[-1] + ea[-1])) -
               ay * ((c[0] + c[row]) * (n[0] + na[0]) - (*(c - row) + c[0]) * (*(n - row) + *(na - row))) -
               az * (top * top - bottom * bottom);
    }
};

struct MomentumStep {
    double dt;         // [s]; used by the explicit step
    double now, then;  // weights of this step's and the last step's tendency
    double nu;         // [m^2/s]
    double force[3];   // uniform force a unit mass [m/s^2]
};

struct VelocityArrays {
    double *u, *v, *w;
};

// The same, read alone.
struct VelocityView {
    const double *u, *v, *w;
    VelocityView(const double* u, const double* v, const double* w) : u(u), v(v), w(w) {}
    VelocityView(const VelocityArrays& q) : u(q.u), v(q.v), w(q.w) {}
};

// One row of faces: the tendency replaces the stored one, `finish(i, total)` gets now*new - then*stored -
// grad p + force.
template <class Advection, class Finish>
inline void momentum_row(int nx, std::size_t offset, double* stored, const double* p, const double* p_next,
                         double inverse_spacing, const MomentumStep& step, double force, Advection&& tendency,
                         Finish&& finish) {
#pragma omp simd
    for (int n = 1; n <= nx; ++n) {
        const std::size_t i = offset + n;
        const double fresh = tendency(i);
        const double total =
            step.now * fresh - step.then * stored[i] - (p_next[i] - p[i]) * inverse_spacing + force;
        stored[i] = fresh;
        finish(i, total);
    }
}

// The explicit step changes the velocity in place, the other one reads it.
template <bool explicit_diffusion>
using StepVelocity = std::conditional_t<explicit_diffusion, VelocityArrays, VelocityView>;

// Planes of one thread, bottom to top. `scratch`: 9 planes a thread (three components: below, here, one saved
// above). explicit_diffusion: velocity += dt * total in place; otherwise total + nu lap(velocity) goes to
// `rate`.
template <bool explicit_diffusion>
inline void momentum_planes(const Grid& g, StepVelocity<explicit_diffusion> q, VelocityArrays stored,
                            VelocityArrays rate, const double* p, const MomentumStep& step, double* scratch,
                            int first, int last, const auto& wait) {
    const std::size_t plane = g.plane(), row = g.row(), bytes = plane * sizeof(double);
    const Tendency t(g, step.nu);
    decltype(q.u) field[3] = {q.u, q.v, q.w};
    VelocityArrays result = rate;
    if constexpr (explicit_diffusion) result = q;
    double* buffer[3][3];
    const double* old[3][3];
    if constexpr (explicit_diffusion) {
        for (int c = 0; c < 3; ++c) {
            for (int b = 0; b < 3; ++b) buffer[c][b] = scratch + (3 * c + b) * plane;
            std::memcpy(buffer[c][0], field[c] + (first - 1) * plane, bytes);
            std::memcpy(buffer[c][2], field[c] + last * plane, bytes);
        }
    }
    wait();  // the neighbours may overwrite their edge planes only now
    for (int k = first; k < last; ++k) {
        const std::size_t base = k * plane;
        for (int c = 0; c < 3; ++c) {
            if constexpr (explicit_diffusion) {
                std::memcpy(buffer[c][1], field[c] + base, bytes);
                old[c][0] = buffer[c][0];
                old[c][1] = buffer[c][1];
                old[c][2] = k + 1 == last ? buffer[c][2] : field[c] + base + plane;
            } else {
                for (int b = 0; b < 3; ++b)
                    old[c][b] = field[c] + base + (b - 1) * static_cast<std::ptrdiff_t>(plane);
            }
        }
        const Window u{old[0][0], old[0][1], old[0][2]}, v{old[1][0], old[1][1], old[1][2]},
            w{old[2][0], old[2][1], old[2][2]};
        const double *pk = p + base, *pa = pk + plane;
        double *su = stored.u + base, *sv = stored.v + base, *sw = stored.w + base;
        const auto finish = [&](double* target, const Window& self) {
            return [&t, &step, target, self](std::size_t i, double total) {
                if constexpr (explicit_diffusion)
                    target[i] = self.here[i] + step.dt * total;
                else
                    target[i] = total + t.diffusion(self, i);
            };
        };
        const auto tendency = [&](auto advection, const Window& self) {
            return [&, advection, self](std::size_t i) {
                if constexpr (explicit_diffusion)
                    return advection(i) + t.diffusion(self, i);
                else
                    return advection(i);
            };
        };
        double *tu = result.u + base, *tv = result.v + base, *tw = result.w + base;
        const bool inner_face = k <= g.last_face(2);
        for (int j = 1; j <= g.ny(); ++j) {
            const std::size_t o = j * row;
            momentum_row(g.nx(), o, su, pk, pk + 1, 1.0 / g.spacing[0], step, step.force[0],
                         tendency([&](std::size_t i) { return t.advection_u(u, v, w, i); }, u),
                         finish(tu, u));
            momentum_row(g.nx(), o, sv, pk, pk + row, 1.0 / g.spacing[1], step, step.force[1],
                         tendency([&](std::size_t i) { return t.advection_v(u, v, w, i); }, v),
                         finish(tv, v));
            if (inner_face)
                momentum_row(g.nx(), o, sw, pk, pa, 1.0 / g.spacing[2], step, step.force[2],
                             tendency([&](std::size_t i) { return t.advection_w(u, v, w, i); }, w),
                             finish(tw, w));
        }
        if constexpr (explicit_diffusion)
            for (int c = 0; c < 3; ++c) std::swap(buffer[c][0], buffer[c][1]);
    }
}

template <bool explicit_diffusion>
inline void momentum(const Grid& g, StepVelocity<explicit_diffusion> q, VelocityArrays stored,
                     VelocityArrays rate, const double* p, const MomentumStep& step, double* scratch) {
    const int threads = std::min(g.threads, g.nz());
#pragma omp parallel num_threads(threads)
    {
        const int team = omp_get_num_threads(), me = omp_get_thread_num();
        const auto [first, last] = share_of(g.nz(), me, team);
        const auto wait = [] {
#pragma omp barrier
        };
        momentum_planes<explicit_diffusion>(g, q, stored, rate, p, step, scratch + 9 * me * g.plane(), first,
                                            last, wait);
    }
}

}  // namespace rdpm
