// Transforms of one plane along x and y: cosines between walls, real Fourier across a periodic pair.
//
// A few rows or columns at a time are copied into vectors and transformed together by plans and in buffers
// made once.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "ducc0/fft/fft.h"
#include "ducc0/fft/fft1d_impl.h"
#include "ducc0/infra/simd.h"
#include "rdpm/grid/grid.hpp"

namespace rdpm {

using Lanes = ducc0::native_simd<double>;

// Transforms of one length, a vector of them at a time.
class LineTransform {
  public:
    LineTransform(int length, bool is_periodic) : length_(length) {
        if (is_periodic)
            fourier_.emplace(length);
        else
            cosine_.emplace(length);
    }
    std::size_t length() const { return length_; }
    std::size_t buffer() const { return fourier_ ? fourier_->bufsize() : cosine_->bufsize(); }
    // The factor that makes backward after forward the identity.
    double normalisation() const { return 1.0 / ((fourier_ ? 1.0 : 2.0) * static_cast<double>(length_)); }
    // The result is in `lines` or in `buffer`.
    Lanes* apply(Lanes* lines, Lanes* buffer, bool is_forward) const {
        if (fourier_) return fourier_->exec(lines, buffer, 1.0, is_forward);
        return cosine_->exec(lines, buffer, 1.0, false, is_forward ? 2 : 3, true);
    }

  private:
    std::size_t length_;
    std::optional<ducc0::detail_fft::pocketfft_r<double>> fourier_;
    std::optional<ducc0::detail_fft::T_dcst23<double>> cosine_;
};

class PlaneTransform {
  public:
    explicit PlaneTransform(const Grid& g)
        : row_(static_cast<std::ptrdiff_t>(g.row())),
          along_x_(g.nx(), g.boundary[0] == periodic),
          along_y_(g.ny(), g.boundary[1] == periodic) {
        const std::size_t size =
            std::max(along_x_.length() + along_x_.buffer(), along_y_.length() + along_y_.buffer());
        scratch_.assign(g.threads, std::vector<Lanes>(size));
    }

    std::size_t bytes() const { return scratch_.size() * scratch_[0].size() * sizeof(Lanes); }
    // The factor that makes backward(forward(q)) the identity.
    double normalisation() const { return along_x_.normalisation() * along_y_.normalisation(); }
    // q: the first inner cell of a plane; in place. Each thread of a team has its own buffers.
    void forward(double* q) { apply(q, true); }
    void backward(double* q) { apply(q, false); }

  private:
    static constexpr std::ptrdiff_t width = Lanes::size();

    void apply(double* q, bool is_forward) {
        Lanes* lines = scratch_[omp_get_thread_num()].data();
        columns(q, lines, is_forward);
        rows(q, lines, is_forward);
    }
    // Beyond the last column the halo and the next row are read, and not written.
    void columns(double* q, Lanes* lines, bool is_forward) {
        const auto nx = static_cast<std::ptrdiff_t>(along_x_.length()),
                   ny = static_cast<std::ptrdiff_t>(along_y_.length());
        for (std::ptrdiff_t i = 0; i < nx; i += width) {
            for (std::ptrdiff_t j = 0; j < ny; ++j)
                lines[j] = Lanes(q + j * row_ + i, ducc0::element_aligned_tag());
            const Lanes* result = along_y_.apply(lines, lines + ny, is_forward);
            if (i + width <= nx) {
                for (std::ptrdiff_t j = 0; j < ny; ++j)
                    result[j].copy_to(q + j * row_ + i, ducc0::element_aligned_tag());
            } else {
                for (std::ptrdiff_t j = 0; j < ny; ++j)
                    for (std::ptrdiff_t n = 0; n < nx - i; ++n) q[j * row_ + i + n] = result[j][n];
            }
        }
    }
    // Beyond the last row nothing is read.
    void rows(double* q, Lanes* lines, bool is_forward) {
        const auto nx = static_cast<std::ptrdiff_t>(along_x_.length()),
                   ny = static_cast<std::ptrdiff_t>(along_y_.length());
        for (std::ptrdiff_t j = 0; j < ny; j += width) {
            const std::ptrdiff_t count = std::min(width, ny - j);
            double* first = q + j * row_;
            if (count < width) std::fill(lines, lines + nx, Lanes(0.0));
            if (count == width) {
                for (std::ptrdiff_t i = 0; i < nx; ++i)
                    for (std::ptrdiff_t n = 0; n < width; ++n) lines[i][n] = first[n * row_ + i];
            } else {
                for (std::ptrdiff_t i = 0; i < nx; ++i)
                    for (std::ptrdiff_t n = 0; n < count; ++n) lines[i][n] = first[n * row_ + i];
            }
            const Lanes* result = along_x_.apply(lines, lines + nx, is_forward);
            for (std::ptrdiff_t i = 0; i < nx; ++i)
                for (std::ptrdiff_t n = 0; n < count; ++n) first[n * row_ + i] = result[i][n];
        }
    }
    std::ptrdiff_t row_;
    LineTransform along_x_, along_y_;
    std::vector<std::vector<Lanes>> scratch_;
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
