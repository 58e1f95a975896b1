// The tridiagonal solve along z of every mode, eliminated from both ends towards the middle.
//
// Row k of a mode: b x_k - x_{k-1} - x_{k+1} = r_k, b = 2 + lambda dz^2. Elimination gives x_k = g_k + c_k
// x_{k+1} (+ e_k X where the direction is periodic: X is the value of the last plane, left out of the
// elimination and found at the end). c_k tends to the mode's decay rate rho and e_k to zero within a few
// planes except for the longest waves, which come first in every row of modes: only those few leave their
// limit and are stored.
#pragma once
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

struct Half {  // of the planes, from its end (t = 0) to the middle (t = planes - 1)
    int planes = 0;
    std::vector<double> c, e,
        sum;  // at the middle: c, product of all c, and the sum of e_{t-1} e_t; a plane of modes each
};

class Tridiagonal {
  public:
    Tridiagonal(int nx, int ny, int nz, double dz, const std::vector<double>& lambda_x,
                const std::vector<double>& lambda_y, bool is_periodic)
        : nx_(nx), ny_(ny), periodic_(is_periodic), c_(nx, ny), e_(nx, ny) {
        const int inner = nz - (is_periodic ? 1 : 0);
        half_[0].planes = inner / 2;
        half_[1].planes = inner - inner / 2;
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
        build();
    }

    int planes(int half) const { return half_[half].planes; }
    bool is_periodic() const { return periodic_; }
    std::size_t bytes() const { return c_.bytes() + e_.bytes() + 8 * rho_.size() * sizeof(double); }

    // Row j of plane t of a half: r -> g, in place. `inner`: g of plane t-1; `gather`: running sum for the
    // periodic closure.
    void eliminate(int t, int j, double* r, const double* inner, double* gather) const {
        const int n = c_.count(t, j);
        const double *c = c_.row(t, j), *rho = rho_.data() + static_cast<std::size_t>(j) * nx_;
        if (t == 0) {
            for (int i = 0; i < n; ++i) r[i] *= c[i];
            for (int i = n; i < nx_; ++i) r[i] *= rho[i];
        } else {
            for (int i = 0; i < n; ++i) r[i] = (r[i] + inner[i]) * c[i];
            for (int i = n; i < nx_; ++i) r[i] = (r[i] + inner[i]) * rho[i];
        }
        if (!periodic_) return;
        if (t == 0) {
            for (int i = 0; i < nx_; ++i) gather[i] = r[i];
        } else {
            const double* e = e_.row(t - 1, j);
            for (int i = 0, m = e_.count(t - 1, j); i < m; ++i) gather[i] += e[i] * r[i];
        }
    }

    // Row j of plane t: carry (x of plane t+1) -> x of plane t, from its g.
    void substitute(int t, int j, const double* g, double* carry, const double* closing) const {
        const int n = c_.count(t, j);
        const double *c = c_.row(t, j), *rho = rho_.data() + static_cast<std::size_t>(j) * nx_;
        for (int i = 0; i < n; ++i) carry[i] = g[i] + c[i] * carry[i];
        for (int i = n; i < nx_; ++i) carry[i] = g[i] + rho[i] * carry[i];
        if (!periodic_) return;
        const double* e = e_.row(t, j);
        for (int i = 0, m = e_.count(t, j); i < m; ++i) carry[i] += e[i] * closing[i];
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

  private:
    void build() {
        const std::size_t modes = rho_.size();
        const std::vector<double> zero(modes, 0.0);
        std::vector<double> c(modes), e(modes), before(modes, 1.0), sum(modes, 0.0);
        const int longest = half_[1].planes;
        for (int t = 0; t < longest; ++t) {
            for (std::size_t m = 0; m < modes; ++m) {
                const double b = diagonal_[m];
                c[m] = t == 0 ? 1.0 / (periodic_ ? b : b - 1.0) : 1.0 / (b - c[m]);
                e[m] = before[m] * c[m];
                sum[m] += before[m] * e[m];
                before[m] = e[m];
            }
            c_.append(c, rho_, 1e-16);
            if (periodic_) e_.append(e, zero, 1e-20);
            for (Half& h : half_)
                if (t == h.planes - 1) {
                    h.c = c;
                    h.e = e;
                    h.sum = sum;
                }
        }
    }
    int nx_, ny_;
    bool periodic_;
    std::vector<double> diagonal_, rho_;
    LeadingModes c_, e_;
    Half half_[2];
};

}  // namespace rdpm
