// The forward pass over a relaxed plan without a division a step: what a search computes most often.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "labelling/lanes.hpp"

namespace explicable {

// For each label of the last step its weight, and that weight times the mean of each power of the number of inexplicable
// steps (beyond `start`, for precision). Only ratios count, so all may be scaled together.
template <int kPowers>
class Tally {
public:
    // From the probability that the last label is "inexplicable", and count and variance given the last label.
    Tally(double p, const std::array<double, 2>& count, const std::array<double, 2>& variance, bool is_empty)
        : start_((1 - p) * count[0] + p * count[1]), is_empty_(is_empty) {
        for (std::size_t label = 0; label < 2; ++label) {
            const double weight = label == 1 ? p : 1 - p, beyond = count[label] - start_;
            moment_[label][0] = weight;
            moment_[label][1] = weight * beyond;
            if constexpr (kPowers > 1) moment_[label][2] = weight * (variance[label] + beyond * beyond);
        }
    }

    double mean() const { return start_ + total(1) / total(0); }
    double variance() const {
        const double beyond = total(1) / total(0);
        return std::max(total(2) / total(0) - beyond * beyond, 0.0);
    }

    // `factors`: of the labels before and after, none above 1; `score`: log odds of "inexplicable", -infinity for a human step.
    // Nothing overflows, since no factor exceeds 1; nothing vanishes, since it is scaled up in time.
    void append(const std::array<std::array<double, 2>, 2>& factors, double score) {
        add_step(factors);
        // Looked up rather than branched on: which of the two is less likely cannot be predicted.
        const std::array<double, 2> factor{1, std::exp(-std::abs(score))};
        const bool likely = score > 0;
        for (double& of_power : moment_[0]) of_power *= factor[likely];
        for (double& of_power : moment_[1]) of_power *= factor[!likely];
        if (const double sum = total(0); sum < 1e-30) scale(sum);
    }
    // The same with odds of no more than 1e270.
    void append_odds(const std::array<std::array<double, 2>, 2>& factors, double odds) {
        if (is_empty_) [[unlikely]] {
            add_step(factors);
            for (double& of_power : moment_[1]) of_power *= odds;
        } else if constexpr (kPowers == 1) {
            const Two before{moment_[0][0], moment_[0][1]}, other{moment_[1][0], moment_[1][1]};
            const Two of_other = before * (factors[0][1] * odds) + other * (factors[1][1] * odds);
            const Two of_explicable = before * factors[0][0] + other * factors[1][0];
            moment_ = {{{of_explicable[0], of_explicable[1]}, {of_other[0], of_other[1] + of_other[0]}}};
        }
        if (const double sum = total(0); sum < 1e-30 || sum > 1e30) scale(sum);
    }

private:
    void add_step(const std::array<std::array<double, 2>, 2>& factors) {
        auto& [explicable, other] = moment_;
        if (is_empty_)
            explicable[0] = other[0] = 1;
        else
            for (std::size_t power = 0; power <= kPowers; ++power) {
                const double before = explicable[power];
                explicable[power] = before * factors[0][0] + other[power] * factors[1][0];
                other[power] = before * factors[0][1] + other[power] * factors[1][1];
            }
        is_empty_ = false;
        // One more is inexplicable: (c + 1)^2 = c^2 + 2 c + 1.
        if constexpr (kPowers > 1) other[2] += 2 * other[1] + other[0];
        other[1] += other[0];
    }
    void scale(double sum) {
        for (auto& of_powers : moment_)
            for (double& of_power : of_powers) of_power /= sum;
    }
    double total(std::size_t power) const { return moment_[0][power] + moment_[1][power]; }

    std::array<std::array<double, kPowers + 1>, 2> moment_{};  // label, power
    double start_;
    bool is_empty_;
};

}  // namespace explicable
