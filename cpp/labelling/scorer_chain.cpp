// What a scorer keeps of the labels of a path: the forward pass and Viterbi's, one step at a time.
#include <algorithm>
#include <cmath>
#include <limits>

#include "labelling/scorer.hpp"

namespace explicable {
namespace {

constexpr double kImpossible = -std::numeric_limits<double>::infinity();

}  // namespace

void Scorer::append(Chain& chain, bool is_human, double score) const {
    if (expected_)
        append_expected(chain, is_human, score);
    else
        append_best(chain, is_human, score);
    chain.is_empty = false;
}

// Viterbi's step; ties go to "explicable", the first label.
void Scorer::append_best(Chain& chain, bool is_human, double score) const {
    std::array<double, 2> best{0, score};
    std::array<double, 2> count{0, 1};
    if (!chain.is_empty) {
        for (std::size_t j = 0; j < 2; ++j) {
            const double from_explicable = transitions_[0][j], from_other = chain.odds + transitions_[1][j];
            const auto before = static_cast<std::size_t>(from_other > from_explicable);
            best[j] += before == 0 ? from_explicable : from_other;
            count[j] += chain.count[before];
        }
    }
    chain.odds = is_human ? kImpossible : best[1] - best[0];
    chain.count = {count[0], is_human ? count[0] : count[1]};
}

// The forward pass, with mean and variance of the number of inexplicable steps given the label of the last.
void Scorer::append_expected(Chain& chain, bool is_human, double score) const {
    std::array<double, 2> weight{1, 1};
    std::array<double, 2> mean{0, 1}, variance{0, 0};
    if (!chain.is_empty) {
        const std::array<double, 2> before{1 - chain.odds, chain.odds};
        for (std::size_t j = 0; j < 2; ++j) {
            const double other = before[1] * factors_[1][j];
            weight[j] = before[0] * factors_[0][j] + other;
            const double share = weight[j] > 0 ? other / weight[j] : 0;
            const double spread = chain.count[1] - chain.count[0];
            mean[j] += chain.count[0] + share * spread;
            variance[j] = chain.variance[0] + share * (chain.variance[1] - chain.variance[0]) +
                          share * (1 - share) * spread * spread;
        }
    }
    if (is_human) {
        chain.odds = 0;
        chain.count = {mean[0], mean[0]};
        chain.variance = {variance[0], variance[0]};
        return;
    }
    // The larger factor is 1, so that nothing overflows.
    weight[score > 0 ? 0 : 1] *= std::exp(-std::abs(score));
    chain.odds = weight[1] / (weight[0] + weight[1]);
    chain.count = mean;
    chain.variance = variance;
}

template <int kPowers>
Scorer::Tally<kPowers>::Tally(const Chain& chain)
    : start((1 - chain.odds) * chain.count[0] + chain.odds * chain.count[1]), is_empty(chain.is_empty) {
    for (std::size_t label = 0; label < 2; ++label) {
        const double weight = label == 1 ? chain.odds : 1 - chain.odds, beyond = chain.count[label] - start;
        moment[0][label] = weight;
        moment[1][label] = weight * beyond;
        if constexpr (kPowers > 1) moment[2][label] = weight * (chain.variance[label] + beyond * beyond);
    }
}

template <int kPowers>
double Scorer::Tally<kPowers>::variance() const {
    const double beyond = total(1) / total(0);
    return std::max(total(2) / total(0) - beyond * beyond, 0.0);
}

// The forward pass once more. Nothing overflows, since no factor exceeds 1; nothing vanishes, since it is scaled up in time.
template <int kPowers>
void Scorer::append(Tally<kPowers>& tally, bool is_human, double score) const {
    auto& moment = tally.moment;
    if (tally.is_empty)
        moment[0] = {1, 1};
    else
        for (auto& [explicable, other] : moment) {
            const double before = explicable;
            explicable = before * factors_[0][0] + other * factors_[1][0];
            other = before * factors_[0][1] + other * factors_[1][1];
        }
    tally.is_empty = false;
    if (is_human) {
        for (auto& of_labels : moment) of_labels[1] = 0;
    } else {
        // One more is inexplicable: (c + 1)^2 = c^2 + 2 c + 1.
        if constexpr (kPowers > 1) moment[2][1] += 2 * moment[1][1] + moment[0][1];
        moment[1][1] += moment[0][1];
        const double less = std::exp(-std::abs(score));
        const std::array<double, 2> factor{score > 0 ? less : 1, score > 0 ? 1 : less};
        for (auto& of_labels : moment)
            for (std::size_t label = 0; label < 2; ++label) of_labels[label] *= factor[label];
    }
    const double sum = tally.total(0);
    if (sum > 1e-30) return;
    for (auto& of_labels : moment)
        for (double& of_label : of_labels) of_label /= sum;
}

template struct Scorer::Tally<1>;
template struct Scorer::Tally<2>;
template void Scorer::append(Tally<1>&, bool, double) const;
template void Scorer::append(Tally<2>&, bool, double) const;

}  // namespace explicable
