// The tridiagonal solve along z of every mode, eliminated from both ends towards the middle.
//
// Row k of a mode: b x_k - x_{k-1} - x_{k+1} = r_k, b = 2 + lambda dz^2. Elimination gives x_k = g_k + c_k
// x_{k+1} (+ e_k X where the direction is periodic: X is the value of the last plane, left out of the
// elimination and found at the end). c_k tends to the mode's decay rate rho and e_k to zero within a few
// planes except for the longest waves, which come first in every row of modes: only those few leave their
// limit and are stored. A half that begins at another slab carries e_k times the value beyond its end
// likewise.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace rdpm {

// Planes of factors of which only the leading modes of each row differ from the limit.
class LeadingModes {
  public:
    LeadingModes(int nx, int ny) : nx_(nx), ny_(ny) {}
    void append(const std::vector<double>& values, const std::vector<double>& limit, double tolerance) {
        for (int j = 0; j < ny_; ++j) {
            const std::ptrdiff_t o = static_cast<std::ptrdiff_t>(j) * nx_;
            int n = nx_;
            while (n > 0 && std::abs(values[o + n - 1] - limit[o + n - 1]) <= tolerance) --n;
            first_.push_back(data_.size());
            count_.push_back(n);
            data_.insert(data_.end(), values.begin() + o, values.begin() + o + n);
        }
    }
    int count(int plane, int j) const { return count_[static_cast<std::size_t>(plane) * ny_ + j]; }
    const double* row(int plane, int j) const {
        return data_.data() + first_[static_cast<std::size_t>(plane) * ny_ + j];
    }
    std::size_t bytes() const {
        return data_.size() * sizeof(double) + count_.size() * (sizeof(int) + sizeof(std::size_t));
    }

  private:
    int nx_, ny_;
    std::vector<double> data_;
    std::vector<std::size_t> first_;
    std::vector<int> count_;
};

// Factors of the elimination from one kind of end.
struct Elimination {
    bool has_outer;  // a value beyond the end enters, with e
    LeadingModes c, e;
};

struct Half {                  // of the planes, from its end (t = 0) to the middle (t = planes - 1)
    int planes = 0, kind = 0;  // which elimination
    std::vector<double> c, e,
        sum;  // at the middle: c, product of all c, and the sum of e_{t-1} e_t; a plane of modes each
};

class Tridiagonal {
  public:
    Tridiagonal(int nx, int ny, int nz, double dz, const std::vector<double>& lambda_x,
                const std::vector<double>& lambda_y, bool is_periodic, std::array<bool, 2> joined)
        : nx_(nx), ny_(ny), periodic_(is_periodic) {
        const int inner = nz - (is_periodic ? 1 : 0);
        half_[0].planes = inner / 2;
        half_[1].planes = inner - inner / 2;
        for (int half = 0; half < 2; ++half) {
            const bool has_outer = is_periodic || joined[half];
            if (half == 1 && has_outer == kind_[0].has_outer) continue;
            half_[half].kind = static_cast<int>(kind_.size());
            kind_.push_back({has_outer, {nx, ny}, {nx, ny}});
        }
        const std::size_t modes = static_cast<std::size_t>(nx) * ny;
        diagonal_.resize(modes);
        rho_.resize(modes);
        for (int j = 0; j < ny; ++j)
            for (int i = 0; i < nx; ++i) {
                const double m = (lambda_x[i] + lambda_y[j]) * dz * dz;
                const std::size_t o = static_cast<std::size_t>(j) * nx + i;
                diagonal_[o] = 2.0 + m;
                rho_[o] = 1.0 / (1.0 + 0.5 * m + std::sqrt(m + 0.25 * m * m));
            }
        for (int kind = 0; kind < static_cast<int>(kind_.size()); ++kind) build(kind);
    }

    int planes(int half) const { return half_[half].planes; }
    bool is_periodic() const { return periodic_; }
    bool has_outer(int half) const { return kind_[half_[half].kind].has_outer; }
    std::size_t bytes() const {
        std::size_t sum = 8 * rho_.size() * sizeof(double);
        for (const Elimination& kind : kind_) sum += kind.c.bytes() + kind.e.bytes();
        return sum;
    }

    // Row j of plane t of a half: r -> g, in place. `before`: g of plane t-1; `gather`: running sum for the
    // periodic closure, or for the value at an end.
    void eliminate(int half, int t, int j, double* r, const double* before, double* gather) const {
        const Elimination& kind = kind_[half_[half].kind];
        const int n = kind.c.count(t, j);
        const double *c = kind.c.row(t, j), *rho = rho_.data() + static_cast<std::size_t>(j) * nx_;
        if (t == 0) {
            for (int i = 0; i < n; ++i) r[i] *= c[i];
            for (int i = n; i < nx_; ++i) r[i] *= rho[i];
        } else {
#pragma omp simd
            for (int i = 0; i < n; ++i) r[i] = (r[i] + before[i]) * c[i];
#pragma omp simd
            for (int i = n; i < nx_; ++i) r[i] = (r[i] + before[i]) * rho[i];
        }
        if (!kind.has_outer) return;
        if (t == 0) {
            for (int i = 0; i < nx_; ++i) gather[i] = r[i];
        } else {
            const double* e = kind.e.row(t - 1, j);
            for (int i = 0, m = kind.e.count(t - 1, j); i < m; ++i) gather[i] += e[i] * r[i];
        }
    }

    // Row j of plane t of a half: carry (x of plane t+1) -> x of plane t, from its g. `outer`: the value
    // beyond its end.
    void substitute(int half, int t, int j, const double* g, double* carry, const double* outer) const {
        const Elimination& kind = kind_[half_[half].kind];
        const int n = kind.c.count(t, j);
        const double *c = kind.c.row(t, j), *rho = rho_.data() + static_cast<std::size_t>(j) * nx_;
#pragma omp simd
        for (int i = 0; i < n; ++i) carry[i] = g[i] + c[i] * carry[i];
#pragma omp simd
        for (int i = n; i < nx_; ++i) carry[i] = g[i] + rho[i] * carry[i];
        if (!kind.has_outer) return;
        const double* e = kind.e.row(t, j);
        for (int i = 0, m = kind.e.count(t, j); i < m; ++i) carry[i] += e[i] * outer[i];
    }

    // Row j where the halves meet: g of both middle planes -> their x; with a periodic direction r of the
    // last plane -> X.
    void meet(int j, double* lower, double* upper, const double* gather_lower, const double* gather_upper,
              double* closing) const {
        const std::size_t o = static_cast<std::size_t>(j) * nx_;
        for (int i = 0; i < nx_; ++i) {
            const double cl = half_[0].c[o + i], cu = half_[1].c[o + i];
            const bool singular =
                j == 0 && i == 0;  // the mean of the box: any constant solves it, one is chosen
            if (!periodic_) {
                if (singular) {
                    upper[i] = 0.0;
                    continue;
                }
                const double x = (lower[i] + cl * upper[i]) / (1.0 - cl * cu);
                upper[i] += cu * x;
                lower[i] = x;
                continue;
            }
            const double el = half_[0].e[o + i], eu = half_[1].e[o + i], inverse = 1.0 / (1.0 - cl * cu);
            const double a0 = (lower[i] + cl * upper[i]) * inverse, a1 = (el + cl * eu) * inverse;
            const double b0 = (upper[i] + cu * lower[i]) * inverse, b1 = (eu + cu * el) * inverse;
            if (singular) {
                closing[i] = 0.0;
            } else {
                const double pivot =
                    diagonal_[o + i] - half_[0].sum[o + i] - half_[1].sum[o + i] - el * b1 - eu * a1;
                closing[i] = (closing[i] + gather_lower[i] + gather_upper[i] + el * b0 + eu * a0) / pivot;
            }
            lower[i] = a0 + a1 * closing[i];
            upper[i] = b0 + b1 * closing[i];
        }
    }

    // Row j of a slab: from g of both middle planes and the gathered sums, the values p of its first and q of
    // its last plane were all values beyond its ends zero.
    void at_ends(int j, const double* lower, const double* upper, const double* gather_lower,
                 const double* gather_upper, double* p, double* q) const {
        const std::size_t o = static_cast<std::size_t>(j) * nx_;
        const bool is_lower = has_outer(0), is_upper = has_outer(1);
        for (int i = 0; i < nx_; ++i) {
            const double cl = half_[0].c[o + i], cu = half_[1].c[o + i], inverse = 1.0 / (1.0 - cl * cu);
            if (is_lower) p[i] = gather_lower[i] + half_[0].e[o + i] * (upper[i] + cu * lower[i]) * inverse;
            if (is_upper) q[i] = gather_upper[i] + half_[1].e[o + i] * (lower[i] + cl * upper[i]) * inverse;
        }
    }

    // Row j of a slab: g of both middle planes -> their x, with the values below and above it.
    void join(int j, double* lower, double* upper, const double* below, const double* above) const {
        const std::size_t o = static_cast<std::size_t>(j) * nx_;
        const bool is_lower = has_outer(0), is_upper = has_outer(1);
        for (int i = 0; i < nx_; ++i) {
            const double cl = half_[0].c[o + i], cu = half_[1].c[o + i], inverse = 1.0 / (1.0 - cl * cu);
            const double l = is_lower ? lower[i] + half_[0].e[o + i] * below[i] : lower[i];
            const double u = is_upper ? upper[i] + half_[1].e[o + i] * above[i] : upper[i];
            lower[i] = (l + cl * u) * inverse;
            upper[i] = (u + cu * l) * inverse;
        }
    }

  private:
    void build(int kind) {
        Elimination& factors = kind_[kind];
        const std::size_t modes = rho_.size();
        const std::vector<double> zero(modes, 0.0);
        std::vector<double> c(modes), e(modes), before(modes, 1.0), sum(modes, 0.0);
        int longest = 0;
        for (const Half& h : half_)
            if (h.kind == kind) longest = std::max(longest, h.planes);
        for (int t = 0; t < longest; ++t) {
            for (std::size_t m = 0; m < modes; ++m) {
                const double b = diagonal_[m];
                c[m] = t == 0 ? 1.0 / (factors.has_outer ? b : b - 1.0) : 1.0 / (b - c[m]);
                e[m] = before[m] * c[m];
                sum[m] += before[m] * e[m];
                before[m] = e[m];
            }
            factors.c.append(c, rho_, 1e-16);
            if (factors.has_outer) factors.e.append(e, zero, 1e-20);
            for (Half& h : half_)
                if (h.kind == kind && t == h.planes - 1) {
                    h.c = c;
                    h.e = e;
                    h.sum = sum;
                }
        }
    }
    int nx_, ny_;
    bool periodic_;
    std::vector<double> diagonal_, rho_;
    std::vector<Elimination> kind_;  // one where both halves begin alike
    Half half_[2];
};

}  // namespace rdpm
