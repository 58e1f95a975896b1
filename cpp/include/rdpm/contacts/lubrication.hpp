// Lubrication between two close surfaces: the part of their resistance that the grid does not resolve.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "rdpm/contacts/layout.hpp"

namespace rdpm::contacts {

// lambda(gap) - lambda(resolved_gap) with lambda = inverse/gap + log*ln(1/gap) [N s/m]; zero beyond
// cutoff_gap. The grid resolves touching surfaces as if they were touching_gap apart and, linearly in
// between, those at cutoff_gap where they are. Constant below least_gap (the roughness); zero in overlap,
// where the solids carry the load: the overlap of a softened contact is no squeeze flow, and would lose all
// of a rebound in it. `separation`: fraction of it where the surfaces part. A row of zeros is a pair without
// lubrication. `slip` and `roll`: tangential resistance per ln(1/gap) [N s/m], each with its own two gaps;
// they act in overlap as at least_gap, for the surfaces then still slide on what is between them, and slow
// neither slip nor roll at more than largest_rate [1/s].
struct LubricationRow {
    double inverse, log, least_gap, cutoff_gap, touching_gap, separation;
    double slip, slip_cutoff_gap, slip_touching_gap, roll, roll_cutoff_gap, roll_touching_gap, largest_rate;

    // Resistance to slip and to roll [N s/m].
    double to_slip(double gap) const {
        return slip * unresolved_log(gap, slip_cutoff_gap, slip_touching_gap);
    }
    double to_roll(double gap) const {
        return roll * unresolved_log(gap, roll_cutoff_gap, roll_touching_gap);
    }

    double unresolved_log(double gap, double cutoff, double touching) const {
        const double g = std::max(gap, least_gap);
        return g < cutoff ? std::log(touching / g + 1 - touching / cutoff) : 0;
    }

    double resolved_gap(double gap) const { return touching_gap + gap * (1 - touching_gap / cutoff_gap); }

    double resistance(double gap) const {
        const double g = std::max(gap, least_gap);
        if (gap <= 0 || !(g < cutoff_gap)) return 0;
        return inverse * (1 / g - 1 / resolved_gap(g)) + log * std::log(resolved_gap(g) / g);
    }

    // Mean over a path of gaps: the impulse of a gap that is crossed in few sub-steps does not depend on
    // where these fall. half_path > 0: approaching.
    double mean_resistance(double gap, double half_path) const {
        const double mean = mean_of_approach(gap, half_path);
        return half_path < 0 ? separation * mean : mean;
    }

    double mean_of_approach(double gap, double half_path) const {
        const double low = gap - std::abs(half_path), high = gap + std::abs(half_path);
        if (high <= 0 || low >= cutoff_gap || least_gap >= cutoff_gap) return 0;
        const double length = high - low;
        if (length < 1e-3 * gap) return resistance(gap);
        const double from = std::clamp(low, least_gap, cutoff_gap),
                     to = std::clamp(high, least_gap, cutoff_gap);
        const double constant = std::min(high, least_gap) - std::max(low, 0.0);
        double impulse = constant > 0 ? constant * resistance(least_gap) : 0;
        const double middle = 0.5 * (from + to), slope = 1 - touching_gap / cutoff_gap;
        const double resolved_part = slope > 1e-6 ? std::log(resolved_gap(to) / resolved_gap(from)) / slope
                                                  : (to - from) / resolved_gap(middle);
        impulse += inverse * (std::log(to / from) - resolved_part);
        impulse += log * (to - from) * std::log(resolved_gap(middle) / middle);
        return impulse / length;
    }
};

inline constexpr std::array lubrication_fields{RDPM_FIELD(LubricationRow, inverse),
                                               RDPM_FIELD(LubricationRow, log),
                                               RDPM_FIELD(LubricationRow, least_gap),
                                               RDPM_FIELD(LubricationRow, cutoff_gap),
                                               RDPM_FIELD(LubricationRow, touching_gap),
                                               RDPM_FIELD(LubricationRow, separation),
                                               RDPM_FIELD(LubricationRow, slip),
                                               RDPM_FIELD(LubricationRow, slip_cutoff_gap),
                                               RDPM_FIELD(LubricationRow, slip_touching_gap),
                                               RDPM_FIELD(LubricationRow, roll),
                                               RDPM_FIELD(LubricationRow, roll_cutoff_gap),
                                               RDPM_FIELD(LubricationRow, roll_touching_gap),
                                               RDPM_FIELD(LubricationRow, largest_rate)};

}  // namespace rdpm::contacts
