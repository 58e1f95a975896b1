// Memory bandwidth: the triad a = b + s c, 24 bytes an element as STREAM counts them.
#pragma once
#include <omp.h>

#include <cstddef>

namespace rdpm {

// Seconds of one sweep over n elements; the arrays are touched first by the threads that use them.
inline double triad_seconds(double* a, double* b, double* c, std::ptrdiff_t n, int threads, int sweeps) {
#pragma omp parallel for num_threads(threads) schedule(static)
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        a[i] = 0.0;
        b[i] = 1.0;
        c[i] = 2.0;
    }
    double best = 1e30;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        const double begin = omp_get_wtime();
#pragma omp parallel for simd num_threads(threads) schedule(static)
        for (std::ptrdiff_t i = 0; i < n; ++i) a[i] = b[i] + 3.0 * c[i];
        const double seconds = omp_get_wtime() - begin;
        if (seconds < best) best = seconds;
    }
    return best;
}

}  // namespace rdpm
