// Momentum: advection and diffusion of the staggered velocity, Adams-Bashforth 2 in time.
//
// What leaves a cell enters the next one: every flux is computed once and kept for the face's other side,
// until the next row (y) or plane (z). The loops walk the planes from bottom to top; since what lies behind
// enters through kept fluxes alone, the new velocity is written over the old one.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "rdpm/grid/grid.hpp"

namespace rdpm {

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

// Through the face between a and b, from a to b, over the spacing across it.
template <bool with_diffusion>
struct FaceFlux {
    double advect, diffuse;  // 1 / (4 spacing): of two sums; nu / spacing^2

    FaceFlux(double spacing, double nu) : advect(0.25 / spacing), diffuse(nu / (spacing * spacing)) {}
    // `carrier`: the sum of the two velocities across the face.
    double operator()(double a, double b, double carrier) const {
        if constexpr (with_diffusion)
            return advect * (a + b) * carrier - diffuse * (b - a);
        else
            return advect * (a + b) * carrier;
    }
};

// The old velocity from one row on: of this plane, the row north of it, the plane above.
struct RowWindow {
    const double *u, *v, *w, *u_north, *v_north, *w_north, *u_above, *v_above, *w_above;

    RowWindow(const double* const here[3], const double* const above[3], std::size_t o, std::size_t row)
        : u(here[0] + o),
          v(here[1] + o),
          w(here[2] + o),
          u_north(u + row),
          v_north(v + row),
          w_north(w + row),
          u_above(above[0] + o),
          v_above(above[1] + o),
          w_above(above[2] + o) {}
};

template <bool with_diffusion>
struct Fluxes {
    using Flux = FaceFlux<with_diffusion>;
    Flux x, y, z;

    Fluxes(const Grid& g, double nu) : x(g.spacing[0], nu), y(g.spacing[1], nu), z(g.spacing[2], nu) {}

    // Through the northern and the upper face around u, v and w.
    auto north_u(const RowWindow& q) const {
        return [q, f = y](int i) { return f(q.u[i], q.u_north[i], q.v[i] + q.v[i + 1]); };
    }
    auto north_v(const RowWindow& q) const {
        return [q, f = y](int i) { return f(q.v[i], q.v_north[i], q.v[i] + q.v_north[i]); };
    }
    auto north_w(const RowWindow& q) const {
        return [q, f = y](int i) { return f(q.w[i], q.w_north[i], q.v[i] + q.v_above[i]); };
    }
    auto upper_u(const RowWindow& q) const {
        return [q, f = z](int i) { return f(q.u[i], q.u_above[i], q.w[i] + q.w[i + 1]); };
    }
    auto upper_v(const RowWindow& q) const {
        return [q, f = z](int i) { return f(q.v[i], q.v_above[i], q.w[i] + q.w_north[i]); };
    }
    auto upper_w(const RowWindow& q) const {
        return [q, f = z](int i) { return f(q.w[i], q.w_above[i], q.w[i] + q.w_above[i]); };
    }
    // Through the faces west of 1 to nx + 1.
    void west(const RowWindow& q, int nx, double* u, double* v, double* w) const {
#pragma omp simd
        for (int i = 1; i <= nx + 1; ++i) {
            u[i] = x(q.u[i - 1], q.u[i], q.u[i - 1] + q.u[i]);
            v[i] = x(q.v[i - 1], q.v[i], q.u[i - 1] + q.u_north[i - 1]);
            w[i] = x(q.w[i - 1], q.w[i], q.u[i - 1] + q.u_above[i - 1]);
        }
    }
};

inline void fill_row(int nx, double* row, const auto& value) {
#pragma omp simd
    for (int i = 1; i <= nx; ++i) row[i] = value(i);
}

// One row of one component: `west`, `south` and `below` are the fluxes into it, and those to the north and
// above replace the last two; the tendency replaces the stored one, `finish(i, total)` gets now*new -
// then*stored - grad p + force.
inline void momentum_row(int nx, const double* west, double* south, double* below, double* stored,
                         const double* p, const double* p_next, double inverse_spacing,
                         const MomentumStep& step, double force, const auto& north, const auto& upper,
                         const auto& finish) {
    const double now = step.now, then = step.then;
#pragma omp simd
    for (int i = 1; i <= nx; ++i) {
        const double to_north = north(i), up = upper(i);
        const double fresh = (west[i] - west[i + 1]) + (south[i] - to_north) + (below[i] - up);
        south[i] = to_north;
        below[i] = up;
        const double total = now * fresh - then * stored[i] - (p_next[i] - p[i]) * inverse_spacing + force;
        stored[i] = fresh;
        finish(i, total);
    }
}

// The explicit step changes the velocity in place, the other one reads it.
template <bool explicit_diffusion>
using StepVelocity = std::conditional_t<explicit_diffusion, VelocityArrays, VelocityView>;

// Planes of scratch a thread: fluxes through the lower faces (3), old velocity above its last plane (3),
// rows.
constexpr std::size_t momentum_scratch = 9;

// The planes of one thread, bottom to top. explicit_diffusion: velocity += dt * total in place; otherwise
// total
// + nu lap(velocity) goes to `rate`.
template <bool explicit_diffusion>
class MomentumSweep {
  public:
    MomentumSweep(const Grid& g, StepVelocity<explicit_diffusion> q, VelocityArrays stored,
                  VelocityArrays rate, const double* p, const MomentumStep& step, double* scratch, int first,
                  int last)
        : g_(g),
          flux_(g, step.nu),
          step_(step),
          field_{q.u, q.v, q.w},
          stored_{stored.u, stored.v, stored.w},
          result_{rate.u, rate.v, rate.w},
          p_(p),
          first_(first),
          last_(last),
          plane_(g.plane()),
          row_(g.row()) {
        for (int c = 0; c < 3; ++c) {
            if constexpr (explicit_diffusion) result_[c] = field_[c];
            below_[c] = scratch + c * plane_;
            saved_[c] = scratch + (3 + c) * plane_;
            west_[c] = scratch + 6 * plane_ + c * row_;
            south_[c] = scratch + 6 * plane_ + (3 + c) * row_;
            inverse_[c] = 1.0 / g.spacing[c];
            diffuse_[c] = step.nu / (g.spacing[c] * g.spacing[c]);
        }
        new_w_ = scratch + 6 * plane_ + 6 * row_;
    }

    // What of the old velocity other threads may overwrite: the plane above, and the fluxes from below.
    void begin() {
        if constexpr (explicit_diffusion)
            for (int c = 0; c < 3; ++c)
                std::memcpy(saved_[c], field_[c] + last_ * plane_, plane_ * sizeof(double));
        look(first_ - 1);
        for (int j = 1; j <= g_.ny(); ++j) {
            const std::size_t o = j * row_;
            const RowWindow old(here_, above_, o, row_);
            fill_row(g_.nx(), below_[0] + o, flux_.upper_u(old));
            fill_row(g_.nx(), below_[1] + o, flux_.upper_v(old));
            fill_row(g_.nx(), below_[2] + o, flux_.upper_w(old));
        }
    }
    void planes() {
        for (int k = first_; k < last_; ++k) {
            look(k);
            const RowWindow halo(here_, above_, 0, row_);
            fill_row(g_.nx(), south_[0], flux_.north_u(halo));
            fill_row(g_.nx(), south_[1], flux_.north_v(halo));
            fill_row(g_.nx(), south_[2], flux_.north_w(halo));
            for (int j = 1; j <= g_.ny(); ++j) row(k, j);
        }
    }

  private:
    void look(int k) {
        for (int c = 0; c < 3; ++c) {
            here_[c] = field_[c] + k * plane_;
            above_[c] = explicit_diffusion && k + 1 == last_ ? saved_[c] : here_[c] + plane_;
        }
    }

    // w first, as its fluxes need the old v; where it replaces w, it waits for v, whose fluxes need the old
    // w.
    void row(int k, int j) {
        const std::size_t o = j * row_, at = k * plane_ + o;
        const RowWindow old(here_, above_, o, row_);
        const bool has_w = k <= g_.last_face(2);  // else the wall
        flux_.west(old, g_.nx(), west_[0], west_[1], west_[2]);
        double* w = explicit_diffusion ? new_w_ : result_[2] + at;
        if (has_w) advance(2, w, o, at, plane_, flux_.north_w(old), flux_.upper_w(old));
        advance(0, result_[0] + at, o, at, 1, flux_.north_u(old), flux_.upper_u(old));
        advance(1, result_[1] + at, o, at, row_, flux_.north_v(old), flux_.upper_v(old));
        if (explicit_diffusion && has_w) std::copy_n(new_w_ + 1, g_.nx(), result_[2] + at + 1);
    }
    // Component c of the row at `o` of its plane and `at` of the field; `next`: to the pressure beyond the
    // face.
    void advance(int c, double* target, std::size_t o, std::size_t at, std::size_t next, const auto& north,
                 const auto& upper) {
        const double *self = here_[c] + o, *p = p_ + at;
        const double dt = step_.dt, dx = diffuse_[0], dy = diffuse_[1], dz = diffuse_[2];
        const std::size_t row = row_, plane = plane_;
        momentum_row(g_.nx(), west_[c], south_[c], below_[c] + o, stored_[c] + at, p, p + next, inverse_[c],
                     step_, step_.force[c], north, upper, [=](int i, double total) {
                         const double* s = self + i;
                         if constexpr (explicit_diffusion)
                             target[i] = *s + dt * total;
                         else
                             target[i] = total + dx * (s[1] - 2.0 * *s + s[-1]) +
                                         dy * (s[row] - 2.0 * *s + *(s - row)) +
                                         dz * (s[plane] - 2.0 * *s + *(s - plane));
                     });
    }

    const Grid& g_;
    const Fluxes<explicit_diffusion> flux_;
    const MomentumStep step_;
    decltype(StepVelocity<explicit_diffusion>::u) field_[3];
    double *stored_[3], *result_[3];
    const double* p_;
    const int first_, last_;
    const std::size_t plane_, row_;
    double *below_[3], *saved_[3], *west_[3], *south_[3], *new_w_;  // scratch
    double inverse_[3], diffuse_[3];                                // 1 / spacing, nu / spacing^2
    const double *here_[3]{}, *above_[3]{};                         // old planes
};

template <bool explicit_diffusion>
inline void momentum(const Grid& g, StepVelocity<explicit_diffusion> q, VelocityArrays stored,
                     VelocityArrays rate, const double* p, const MomentumStep& step, double* scratch) {
    const int threads = std::min(g.threads, g.nz());
#pragma omp parallel num_threads(threads)
    {
        const int team = omp_get_num_threads(), me = omp_get_thread_num();
        const auto [first, last] = share_of(g.nz(), me, team);
        MomentumSweep<explicit_diffusion> sweep(g, q, stored, rate, p, step,
                                                scratch + momentum_scratch * me * g.plane(), first, last);
        sweep.begin();
#pragma omp barrier
        sweep.planes();
    }
}

}  // namespace rdpm
