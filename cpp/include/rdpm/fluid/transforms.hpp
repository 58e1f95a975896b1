// Transforms of one plane along x and y: cosines between walls, real Fourier across a periodic pair.
#pragma once
#include <cmath>
#include <numbers>
#include <vector>

#include "ducc0/fft/fft.h"
#include "ducc0/fft/fftnd_impl.h"
#include "rdpm/grid/grid.hpp"

namespace rdpm {

class PlaneTransform {
  public:
    explicit PlaneTransform(const Grid& g)
        : shape_{static_cast<std::size_t>(g.ny()), static_cast<std::size_t>(g.nx())},
          stride_{static_cast<std::ptrdiff_t>(g.row()), 1},
          periodic_{g.boundary[1] == periodic, g.boundary[0] == periodic} {}

    // The factor that makes backward(forward(q)) the identity.
    double normalisation() const {
        double factor = 1.0;
        for (int axis = 0; axis < 2; ++axis)
            factor /= (periodic_[axis] ? 1.0 : 2.0) * static_cast<double>(shape_[axis]);
        return factor;
    }
    // q: the first inner cell of a plane; in place.
    void forward(double* q) const { apply(q, true); }
    void backward(double* q) const { apply(q, false); }

  private:
    void apply(double* q, bool is_forward) const {
        const ducc0::vfmav<double> a(q, shape_, stride_);
        if (periodic_[0] == periodic_[1]) {
            along(a, {0, 1}, periodic_[0], is_forward);
        } else {
            along(a, {0}, periodic_[0], is_forward);
            along(a, {1}, periodic_[1], is_forward);
        }
    }
    static void along(const ducc0::vfmav<double>& a, const std::vector<std::size_t>& axes, bool is_periodic,
                      bool is_forward) {
        if (is_periodic)
            ducc0::r2r_fftpack(a, a, axes, is_forward, is_forward, 1.0, 1);
        else
            ducc0::dct(a, a, axes, is_forward ? 2 : 3, 1.0, false, 1);
    }
    std::vector<std::size_t> shape_;
    std::vector<std::ptrdiff_t> stride_;
    bool periodic_[2];
};

// Minus the second difference's eigenvalue of every mode along one direction, rising with the index [1/m^2].
inline std::vector<double> mode_eigenvalues(int n, double spacing, bool is_periodic) {
    std::vector<double> value(n);
    for (int m = 0; m < n; ++m) {
        const double angle =
            is_periodic ? 2.0 * std::numbers::pi * ((m + 1) / 2) / n : std::numbers::pi * m / n;
        const double s = 2.0 * std::sin(0.5 * angle) / spacing;
        value[m] = s * s;
    }
    return value;
}

}  // namespace rdpm
