// Projection: the velocity made divergence-free by one direct Poisson solve, streamed through the cache.
//
// Inwards, from both ends of z to the middle, a few planes at a time: divergence -> transform in x and y ->
// elimination in z. Outwards, back: substitution -> inverse transform -> correction of velocity and pressure
// while the plane is in cache. The two halves are independent until they meet, so two threads never wait for
// each other in between; more threads share the planes of a batch and the rows of modes. The arithmetic, and
// so the result, is the same for any number of threads.
//
// Of a slab, `inwards` ends with the values p of its first and q of its last plane were all beyond its ends
// zero; from those of all slabs the true values below and above it are found, with which `outwards` goes
// back. `finish` needs the increment of the plane above, and `measure_flow` the corrected face below.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "rdpm/fluid/measures.hpp"
#include "rdpm/fluid/momentum.hpp"
#include "rdpm/fluid/transforms.hpp"
#include "rdpm/fluid/tridiagonal.hpp"
#include "rdpm/grid/grid.hpp"
#include "rdpm/parallel/team_barrier.hpp"

namespace rdpm {

class Projection {
  public:
    explicit Projection(const Grid& g)
        : g_(g),
          transform_(g),
          solver_(g.nx(), g.ny(), g.nz(), g.spacing[2],
                  mode_eigenvalues(g.nx(), g.spacing[0], g.boundary[0] == periodic),
                  mode_eigenvalues(g.ny(), g.spacing[1], g.boundary[1] == periodic), g.wraps(2), g.joined),
          carry_{modes(), modes()},
          gather_{solver_.has_outer(0) ? modes() : std::vector<double>{},
                  solver_.has_outer(1) ? modes() : std::vector<double>{}},
          plane_cfl_(g.nz() + 2),
          plane_square_(g.nz() + 2),
          measured_above_(g.plane_here((g.whole(2) - (g.boundary[2] == periodic ? 1 : 0)) / 2)) {}

    const Grid& grid() const { return g_; }
    std::size_t bytes() const {
        return solver_.bytes() + transform_.bytes() + 4 * carry_[0].size() * sizeof(double);
    }

    // u, v, w -> divergence-free; p += phi - rotational * div(u before); phi: the pressure increment
    // [m^2/s^2].
    FlowMeasures project(VelocityArrays q, double* p, double* phi, double dt, double rotational) {
        take(q, p, phi, dt, rotational);
        run<true>(Way::whole);
        close();
        return measures(q);
    }

    // The three parts of the same on a slab; `ends`: p and q, then the values below and above, a plane of
    // modes each. The faces between the last plane and the slab above are current in that slab's halo.
    void inwards(VelocityArrays q, double* phi, double dt, std::array<double*, 2> ends) {
        take(q, nullptr, phi, dt, 0.0);
        ends_ = ends;
        run<true>(Way::inwards);
    }
    void outwards(VelocityArrays q, double* p, double* phi, double dt, double rotational,
                  std::array<double*, 2> ends) {
        take(q, p, phi, dt, rotational);
        ends_ = ends;
        run<true>(Way::outwards);
    }
    void finish(VelocityArrays q, double* p, double* phi, double dt) {
        take(q, p, phi, dt, 0.0);
        close();
    }
    // Once the halo of w is current.
    FlowMeasures measure_flow(const VelocityView& q) { return measures(q); }

    // phi: a right-hand side of laplacian(x) = rhs with zero mean -> x. The same passes without the velocity.
    void solve(double* phi) {
        phi_ = phi;
        run<false>(Way::whole);
    }

  private:
    std::vector<double> modes() const {
        return std::vector<double>(static_cast<std::size_t>(g_.nx()) * g_.ny());
    }
    std::size_t row_of_modes(int j) const { return static_cast<std::size_t>(j) * g_.nx(); }
    double* inner(int k) const { return phi_ + k * g_.plane() + g_.row() + 1; }
    int plane_of(int half, int t) const { return half == 0 ? t + 1 : core() - t; }
    int core() const { return g_.nz() - (solver_.is_periodic() ? 1 : 0); }

    enum class Way { whole, inwards, outwards };

    void take(VelocityArrays q, double* p, double* phi, double dt, double rotational) {
        q_ = q;
        p_ = p;
        phi_ = phi;
        dt_ = dt;
        rotational_ = rotational;
    }

    template <bool with_flow>
    void run(Way way) {
        const bool in = way != Way::outwards, out = way != Way::inwards;
        if constexpr (with_flow)
            if (in) prepare_normal_faces();
        // Halves are teams; a single thread does one after the other, then the meeting, then both back.
        const int threads = std::max(1, std::min(g_.threads, 2 * g_.ny()));
#pragma omp parallel num_threads(threads)
        {
            const int all = omp_get_num_threads(), me = omp_get_thread_num();
            if (all == 1) {
                for (int half = 0; in && half < 2; ++half) inwards<with_flow>(half, 0, 1);
                meet(way, 0, 1);
                for (int half = 0; out && half < 2; ++half) outwards<with_flow>(half, 0, 1);
            } else {
                const int lower_team = all / 2, half = me < lower_team ? 0 : 1;
                const int team = half == 0 ? lower_team : all - lower_team,
                          rank = half == 0 ? me : me - lower_team;
                if (in) inwards<with_flow>(half, rank, team);
#pragma omp barrier
                meet(way, me, all);
#pragma omp barrier
                if (out) outwards<with_flow>(half, rank, team);
            }
        }
        if (solver_.is_periodic())
            transform_.backward(inner(g_.nz()));  // X, until now read as a plane of modes
    }

    void prepare_normal_faces() {
        double* w = q_.w;
        const std::size_t bytes = g_.plane() * sizeof(double);
        if (g_.wraps(2)) {
            std::memcpy(w, w + g_.nz() * g_.plane(), bytes);
        } else if (!g_.is_open(2)) {
            if (g_.has_face(2, 0)) std::memset(w, 0, bytes);
            if (g_.has_face(2, 1)) std::memset(w + g_.nz() * g_.plane(), 0, bytes);
        }
    }

    // Faces on and beyond the boundaries of a plane, then r = -dz^2 div(u)/dt times the transforms'
    // normalisation.
    void right_hand_side(int k) const {
        const int nx = g_.nx(), ny = g_.ny();
        const std::size_t row = g_.row(), base = k * g_.plane();
        double *u = q_.u + base, *v = q_.v + base;
        const double *w = q_.w + base, *below = w - g_.plane();
        for (int j = 1; j <= ny && !g_.is_open(0); ++j) {
            double* r = u + j * row;
            if (g_.boundary[0] != periodic) r[nx] = 0.0;
            r[0] = r[nx];
        }
        if (!g_.is_open(1)) {
            if (g_.boundary[1] != periodic) std::fill(v + ny * row, v + ny * row + row, 0.0);
            std::memcpy(v, v + ny * row, row * sizeof(double));
        }
        const double dz = g_.spacing[2], factor = -dz * dz / dt_ * transform_.normalisation();
        const double ix = factor / g_.spacing[0], iy = factor / g_.spacing[1], iz = factor / dz;
        for (int j = 1; j <= ny; ++j) {
            const std::size_t o = j * row;
            double* out = phi_ + base + o;
#pragma omp simd
            for (int i = 1; i <= nx; ++i)
                out[i] = (u[o + i] - u[o + i - 1]) * ix + (v[o + i] - v[o + i - row]) * iy +
                         (w[o + i] - below[o + i]) * iz;
        }
    }
    void scale_right_hand_side(int k) const {
        const double factor = -g_.spacing[2] * g_.spacing[2] * transform_.normalisation();
        for (int j = 0; j < g_.ny(); ++j)
            for (int i = 0; i < g_.nx(); ++i) inner(k)[j * g_.row() + i] *= factor;
    }

    template <bool with_flow>
    void load_and_transform(int k) {
        if constexpr (with_flow)
            right_hand_side(k);
        else
            scale_right_hand_side(k);
        transform_.forward(inner(k));
    }

    template <bool with_flow>
    void inwards(int half, int rank, int team) {
        const int planes = solver_.planes(half), ny = g_.ny();
        const auto [first, last] = share_of(ny, rank, team);
        for (int batch = 0; batch < planes; batch += team) {
            if (batch + rank < planes) load_and_transform<with_flow>(plane_of(half, batch + rank));
            barrier_[half].wait(team);
            for (int t = batch; t < std::min(batch + team, planes); ++t) {
                double* g = inner(plane_of(half, t));
                const double* before = t > 0 ? inner(plane_of(half, t - 1)) : nullptr;
                for (int j = first - 1; j < last - 1; ++j)
                    solver_.eliminate(half, t, j, g + j * g_.row(), before ? before + j * g_.row() : nullptr,
                                      gathered(half, j));
            }
        }
        if (half == 1 && solver_.is_periodic() && rank == 0) load_and_transform<with_flow>(g_.nz());
    }

    double* gathered(int half, int j) {
        return gather_[half].data() + (solver_.has_outer(half) ? row_of_modes(j) : 0);
    }

    void meet(Way way, int rank, int team) {
        const auto [first, last] = share_of(g_.ny(), rank, team);
        const int nx = g_.nx();
        const double *lower = inner(plane_of(0, solver_.planes(0) - 1)),
                     *upper = inner(plane_of(1, solver_.planes(1) - 1));
        for (int j = first - 1; j < last - 1; ++j) {
            double *a = carry_[0].data() + row_of_modes(j), *b = carry_[1].data() + row_of_modes(j);
            if (way == Way::outwards) {
                solver_.join(j, a, b, ends_[0] + row_of_modes(j), ends_[1] + row_of_modes(j));
                continue;
            }
            std::copy_n(lower + j * g_.row(), nx, a);
            std::copy_n(upper + j * g_.row(), nx, b);
            if (way == Way::inwards)
                solver_.at_ends(j, a, b, gathered(0, j), gathered(1, j), ends_[0] + row_of_modes(j),
                                ends_[1] + row_of_modes(j));
            else if (solver_.is_periodic())
                solver_.meet(j, a, b, gathered(0, j), gathered(1, j), inner(g_.nz()) + j * g_.row());
            else
                solver_.meet(j, a, b, nullptr, nullptr, nullptr);
        }
    }

    template <bool with_flow>
    void outwards(int half, int rank, int team) {
        const int planes = solver_.planes(half), ny = g_.ny(), nx = g_.nx();
        const auto [first, last] = share_of(ny, rank, team);
        int face = -1;  // corrected last
        for (int done = 0; done < planes; done += team) {
            for (int n = done; n < std::min(done + team, planes); ++n) {
                const int t = planes - 1 - n;
                double* g = inner(plane_of(half, t));
                for (int j = first - 1; j < last - 1; ++j) {
                    double* carry = carry_[half].data() + row_of_modes(j);
                    if (n > 0) solver_.substitute(half, t, j, g + j * g_.row(), carry, outer(half, j));
                    std::copy_n(carry, nx, g + j * g_.row());
                }
            }
            barrier_[half].wait(team);
            if constexpr (with_flow)
                if (g_.is_slab()) measure_beyond(half, face);
            const int n = done + rank, k = plane_of(half, planes - 1 - std::min(n, planes - 1));
            if (n < planes) {
                transform_.backward(inner(k));
                if constexpr (with_flow) update_pressure(k);
            }
            barrier_[half].wait(team);  // the divergence of the planes beside was still needed
            if constexpr (with_flow) {
                face = n == 0 || n >= planes ? -1 : half == 0 ? k : k - 1;
                if (n < planes) correct(k, face);
            }
        }
        if constexpr (with_flow)
            if (g_.is_slab()) {
                barrier_[half].wait(team);
                measure_beyond(half, face);
            }
    }
    // The value beyond an end: of the last plane, left out of the elimination, or of another slab.
    const double* outer(int half, int j) const {
        if (!solver_.has_outer(half)) return nullptr;
        return solver_.is_periodic() ? inner(g_.nz()) + j * g_.row() : ends_[half] + row_of_modes(j);
    }

    // p += phi - rotational * div(u), before any face around plane k is corrected.
    void update_pressure(int k) {
        const int nx = g_.nx();
        const std::size_t row = g_.row(), plane = g_.plane(), base = k * plane;
        fill_plane_halo(g_, phi_ + base, centre, Walls::moving);
        const double *u = q_.u + base, *v = q_.v + base, *w = q_.w + base, *w_below = w - plane,
                     *phi = phi_ + base;
        double* p = p_ + base;
        const double ix = rotational_ / g_.spacing[0], iy = rotational_ / g_.spacing[1],
                     iz = rotational_ / g_.spacing[2];
        for (int j = 1; j <= g_.ny(); ++j) {
            const std::size_t o = j * row;
            if (rotational_ == 0.0) {
#pragma omp simd
                for (int i = 1; i <= nx; ++i) p[o + i] += phi[o + i];
            } else {
#pragma omp simd
                for (int i = 1; i <= nx; ++i)
                    p[o + i] +=
                        phi[o + i] - ((u[o + i] - u[o + i - 1]) * ix + (v[o + i] - v[o + i - row]) * iy +
                                      (w[o + i] - w_below[o + i]) * iz);
            }
        }
        fill_plane_halo(g_, p, centre, Walls::moving);
    }

    // Velocity of plane k; `face`: the plane of w that lies between k and the plane done before, or -1.
    void correct(int k, int face) {
        const int nx = g_.nx(), ny = g_.ny();
        const std::size_t row = g_.row(), base = k * g_.plane();
        double *u = q_.u + base, *v = q_.v + base;
        const double* phi = phi_ + base;
        const double sx = dt_ / g_.spacing[0], sy = dt_ / g_.spacing[1];
        const int last_x = g_.last_face(0), last_y = g_.last_face(1);
        for (int j = 1; j <= ny; ++j) {
            const std::size_t o = j * row;
#pragma omp simd
            for (int i = 1; i <= last_x; ++i) u[o + i] -= sx * (phi[o + i + 1] - phi[o + i]);
            if (j <= last_y) {
#pragma omp simd
                for (int i = 1; i <= nx; ++i) v[o + i] -= sy * (phi[o + i + row] - phi[o + i]);
            }
        }
        fill_plane_halo(g_, u, face_x, Walls::moving);
        fill_plane_halo(g_, v, face_y, Walls::moving);
        if (face < 0) return;  // a middle plane: the face between the halves is still to come
        correct_faces(face, face + 1);
        measure_with(k, face);
    }

    // w between the planes `below` and `above`.
    void correct_faces(int below, int above) {
        const int nx = g_.nx();
        double* w = q_.w + below * g_.plane();
        const double *a = phi_ + below * g_.plane(), *b = phi_ + above * g_.plane(), s = dt_ / g_.spacing[2];
        for (int j = 1; j <= g_.ny(); ++j) {
            const std::size_t o = j * g_.row();
#pragma omp simd
            for (int i = 1; i <= nx; ++i) w[o + i] -= s * (b[o + i] - a[o + i]);
        }
        fill_plane_halo(g_, w, face_z, Walls::moving);
    }

    // Planes up to the middle of the box are measured with the face above them, those beyond it with the face
    // below, wherever the box is cut. The first of the latter counts the last face, and is left to the end.
    int left_to_end() const { return std::max(1, measured_above_ + 1); }
    void measure_with(int k, int face) {
        if (k >= 1 && k <= g_.nz() && k != left_to_end() && face == (k <= measured_above_ ? k : k - 1))
            measure(q_, k, face, face);
    }
    // In a slab the other plane at a face may be the one that is measured with it; it is corrected by then.
    void measure_beyond(int half, int face) {
        if (face >= 0) measure_with(half == 0 ? face + 1 : face, face);
    }

    void measure(const VelocityView& q, int k, int face, int counted) {
        const FlowMeasures found = measure_plane(g_, q, k, face, counted);
        plane_cfl_[k] = found.cfl_rate;
        plane_square_[k] = found.square_sum;
    }

    // What lies between the halves and across the ends, then the end planes' halos.
    void close() {
        const int nz = g_.nz(), middle = plane_of(0, solver_.planes(0) - 1);
        if (solver_.is_periodic()) {
            update_pressure(nz);
            correct(nz, nz - 1);
            correct_faces(nz, 1);
        } else {
            if (g_.has_face(2, 0)) fill_plane_halo(g_, q_.w, face_z, Walls::moving);
            if (g_.has_face(2, 1)) {
                fill_plane_halo(g_, q_.w + nz * g_.plane(), face_z, Walls::moving);
            } else {
                correct_faces(nz, nz + 1);
                measure_with(nz, nz);
            }
        }
        correct_faces(middle, middle + 1);
        measure_with(middle, middle);
        measure_with(middle + 1, middle);
        for (int c = 0; c < 3; ++c) fill_end_planes(g_, c == 0 ? q_.u : c == 1 ? q_.v : q_.w, c);
        fill_end_planes(g_, p_, centre);
    }

    // The sums in fixed order.
    FlowMeasures measures(const VelocityView& q) {
        const int nz = g_.nz(), k = left_to_end();
        if (k <= nz) measure(q, k, k - 1, nz);
        FlowMeasures all;
        for (int n = 1; n <= nz; ++n) {
            all.cfl_rate = std::max(all.cfl_rate, plane_cfl_[n]);
            all.square_sum += plane_square_[n];
        }
        return all;
    }

    Grid g_;
    PlaneTransform transform_;
    Tridiagonal solver_;
    std::vector<double> carry_[2], gather_[2];
    std::vector<double> plane_cfl_, plane_square_;
    int measured_above_;  // the last plane that is measured with the face above it
    TeamBarrier barrier_[2];
    VelocityArrays q_{};
    double *p_ = nullptr, *phi_ = nullptr;
    double dt_ = 1.0, rotational_ = 0.0;
    std::array<double*, 2> ends_{};
};

}  // namespace rdpm
