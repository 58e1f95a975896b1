// The interfaces of slabs in the solve along z: of each mode, two unknowns where two slabs meet.
//
// Slab i of n planes holds b x_k - x_{k-1} - x_{k+1} = r_k, rho + 1/rho = b, so with the values A below and B
// above it, x_1 = p + alpha A + beta B and x_n = q + alpha' B + beta A: alpha and beta are closed forms in
// rho and n, and only p and q travel. With y_i the last plane below interface i and z_i the first one above
// it,
//     y_i - alpha'_i z_i - beta_i y_{i-1} = q_i,   z_i - alpha_{i+1} y_i - beta_{i+1} z_{i+1} = p_{i+1}.
// Upwards y_i = Y_i + C_i z_i (+ F_i s); downwards z_i. Where z is periodic, s is the last plane of the last
// slab, and t the first plane of the first one: both are found where the two ways meet.
#pragma once
#include <cmath>
#include <cstddef>
#include <vector>

namespace rdpm {

// Answer of a slab of n planes at one of its ends to a unit value there, and across it; `decay`: log(1/rho).
struct SlabAnswer {
    double near, across;
};

inline SlabAnswer slab_answer(double decay, int n, bool is_wall_across) {
    const double rho = std::exp(-decay);
    if (is_wall_across)
        return {rho * (1.0 + std::exp(-(2 * n - 1) * decay)) / (1.0 + std::exp(-(2 * n + 1) * decay)), 0.0};
    if (decay == 0.0) return {n / (n + 1.0), 1.0 / (n + 1.0)};
    const double whole = -std::expm1(-(2 * n + 2) * decay);
    return {rho * -std::expm1(-2 * n * decay) / whole,
            std::exp(-n * decay) * -std::expm1(-2 * decay) / whole};
}

// The interface systems of some modes; the first may be the mean of the box, which any constant solves.
class Interfaces {
  public:
    // `m`: lambda dz^2 of each mode; `planes`: of each slab.
    Interfaces(const std::vector<double>& m, const std::vector<int>& planes, bool is_periodic)
        : modes_(m.size()),
          slabs_(planes.size()),
          periodic_(is_periodic),
          row_(slabs_ * modes_),
          closing_(modes_) {
        for (std::size_t o = 0; o < modes_; ++o) prepare(o, m[o], planes);
    }

    std::size_t modes() const { return modes_; }
    std::size_t slabs() const { return slabs_; }
    std::size_t bytes() const { return row_.size() * sizeof(Row) + closing_.size() * sizeof(Closing); }

    // p and q of each slab -> the values below and above it: (slabs, 2, modes).
    void solve(double* ends, int threads) const {
        const auto modes = static_cast<std::ptrdiff_t>(modes_);
#pragma omp parallel for num_threads(threads) schedule(static) if (modes > 4096)
        for (std::ptrdiff_t o = 0; o < modes; ++o) solve_mode(o, ends + o);
    }

  private:
    struct Row {               // of a slab
        double alpha, beta;    // of its first plane
        double inverse, c, f;  // 1 / (1 - alpha C of the slab below), C and F of its last plane
    };
    struct Closing {
        double of_s, pivot, from_s, from_t;
    };
    const Row& row(std::size_t slab, std::size_t o) const { return row_[slab * modes_ + o]; }

    void prepare(std::size_t o, double m, const std::vector<int>& planes) {
        const double decay = std::log1p(0.5 * m + std::sqrt(m + 0.25 * m * m));
        const std::size_t last = slabs_ - 1;
        for (std::size_t i = 0; i < slabs_; ++i) {
            const SlabAnswer lower = slab_answer(decay, planes[i], !periodic_ && i == last),
                             upper = slab_answer(decay, planes[i], !periodic_ && i == 0);
            Row& here = row_[i * modes_ + o];
            here = {lower.near, lower.across, 1.0, upper.near, i == 0 && periodic_ ? upper.across : 0.0};
            if (i == 0) continue;
            const Row& before = row(i - 1, o);
            const double pivot = 1.0 - here.alpha * before.c;
            // The mean between walls: the last first plane is chosen, nothing is divided by its pivot.
            here.inverse = !periodic_ && i == last && m == 0.0 ? 0.0 : 1.0 / pivot;
            here.c += here.beta * here.beta * before.c * here.inverse;
            here.f = here.beta * before.f * here.inverse;
        }
        if (!periodic_) return;
        // z_0 = Z + from_s s + from_t t
        double from_s = 0.0, from_t = 1.0;
        for (std::size_t i = last; i > 0; --i) {
            const Row &here = row(i, o), &before = row(i - 1, o);
            from_s = (here.alpha * before.f + here.beta * from_s) * here.inverse;
            from_t = here.beta * from_t * here.inverse;
        }
        const Row &first = row(0, o), &top = row(last, o);
        const double of_s = (first.alpha + first.beta * from_s) / (1.0 - top.f);
        const double pivot = 1.0 - first.beta * from_t - of_s * top.c;
        closing_[o] = {of_s, m == 0.0 ? 0.0 : 1.0 / pivot, from_s, from_t};
    }

    void solve_mode(std::size_t o, double* ends) const {
        const std::size_t last = slabs_ - 1;
        const auto p = [&](std::size_t slab) -> double& { return ends[2 * slab * modes_]; };
        const auto q = [&](std::size_t slab) -> double& { return ends[(2 * slab + 1) * modes_]; };
        // Upwards: q becomes Y.
        const std::size_t top = periodic_ ? last : last - 1;
        for (std::size_t i = 1; i <= top; ++i) {
            const Row &here = row(i, o), &before = row(i - 1, o);
            q(i) += here.beta * (q(i - 1) + before.c * p(i)) * here.inverse;
        }
        double s = 0.0, z = 0.0;
        if (periodic_) {
            double of_known = 0.0;  // z_0 without s and t
            for (std::size_t i = last; i > 0; --i) {
                const Row& here = row(i, o);
                of_known = (p(i) + here.alpha * q(i - 1) + here.beta * of_known) * here.inverse;
            }
            const Row &first = row(0, o), &end = row(last, o);
            const Closing& k = closing_[o];
            z = (p(0) + first.beta * of_known + k.of_s * q(last)) * k.pivot;
            s = (q(last) + end.c * z) / (1.0 - end.f);
        }
        // Downwards: above each slab z, below it y.
        for (std::size_t i = last;; --i) {
            const double above = z;
            if (i == 0) {
                q(0) = above;
                p(0) = s;
                break;
            }
            const Row &here = row(i, o), &before = row(i - 1, o);
            z = (p(i) + here.alpha * (q(i - 1) + before.f * s) + here.beta * above) * here.inverse;
            q(i) = above;
            p(i) = q(i - 1) + before.c * z + before.f * s;
        }
    }

    std::size_t modes_, slabs_;
    bool periodic_;
    std::vector<Row> row_;
    std::vector<Closing> closing_;
};

}  // namespace rdpm
