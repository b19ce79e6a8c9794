#include "labelling/chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace explicable {
namespace {

constexpr double kImpossible = -std::numeric_limits<double>::infinity();

double log_sum_exp(std::span<const double> terms) {
    const double largest = *std::max_element(terms.begin(), terms.end());
    if (largest == kImpossible) return kImpossible;
    double sum = 0.0;
    for (const double term : terms) sum += std::exp(term - largest);
    return largest + std::log(sum);
}

// log of the summed weight of all prefixes that end at a position in a label: num_positions x num_labels.
std::vector<double> forward(const Chain& chain) {
    const int num_labels = chain.num_labels;
    const std::size_t num_positions = chain.num_positions();
    std::vector<double> alpha(num_positions * num_labels, kImpossible), terms(num_labels);
    for (std::size_t t = 0; t < num_positions; ++t)
        for (int to = 0; to < num_labels; ++to) {
            if (!chain.allows(t, to)) continue;
            double incoming = 0.0;
            if (t > 0) {
                for (int from = 0; from < num_labels; ++from)
                    terms[from] = alpha[(t - 1) * num_labels + from] + chain.transition[from * num_labels + to];
                incoming = log_sum_exp(terms);
            }
            alpha[t * num_labels + to] = incoming + chain.state[t * num_labels + to];
        }
    return alpha;
}

}  // namespace

bool are_usable_scores(std::span<const double> scores) {
    return std::all_of(scores.begin(), scores.end(), [](double score) { return std::abs(score) <= 1e9; });
}

void viterbi(const Chain& chain, std::span<LabelId> labels) {
    const int num_labels = chain.num_labels;
    const std::size_t num_positions = chain.num_positions();
    if (num_positions == 0) return;
    std::vector<double> best(num_labels), previous(num_labels);
    std::vector<LabelId> predecessors(num_positions * num_labels, 0);
    for (std::size_t t = 0; t < num_positions; ++t) {
        std::swap(best, previous);
        for (int to = 0; to < num_labels; ++to) {
            if (!chain.allows(t, to)) {
                best[to] = kImpossible;
                continue;
            }
            double incoming = 0.0;
            if (t > 0) {
                incoming = kImpossible;
                for (int from = 0; from < num_labels; ++from) {
                    const double score = previous[from] + chain.transition[from * num_labels + to];
                    if (score > incoming) {
                        incoming = score;
                        predecessors[t * num_labels + to] = from;
                    }
                }
            }
            best[to] = incoming + chain.state[t * num_labels + to];
        }
    }
    auto label = static_cast<LabelId>(std::max_element(best.begin(), best.end()) - best.begin());
    for (std::size_t t = num_positions; t-- > 0;) {
        labels[t] = label;
        label = predecessors[t * num_labels + label];
    }
}

double marginals(const Chain& chain, std::span<double> marginals, std::span<double> pair_counts) {
    const int num_labels = chain.num_labels;
    const std::size_t num_positions = chain.num_positions();
    if (num_positions == 0) return 0.0;
    const std::vector<double> alpha = forward(chain);
    const double log_partition =
        log_sum_exp(std::span(alpha).subspan((num_positions - 1) * num_labels, num_labels));
    std::vector<double> beta(num_labels, 0.0), next(num_labels), terms(num_labels), pairs(num_labels * num_labels);
    for (std::size_t t = num_positions; t-- > 0;) {
        // Normalised here and not by the partition function: then rounding of large scores leaves probabilities.
        for (int label = 0; label < num_labels; ++label) terms[label] = alpha[t * num_labels + label] + beta[label];
        const double total = log_sum_exp(terms);
        for (int label = 0; label < num_labels; ++label)
            marginals[t * num_labels + label] = std::exp(terms[label] - total);
        if (t == 0) break;
        for (int to = 0; to < num_labels; ++to)
            next[to] = chain.allows(t, to) ? chain.state[t * num_labels + to] + beta[to] : kImpossible;
        for (int from = 0; from < num_labels; ++from) {
            for (int to = 0; to < num_labels; ++to) {
                terms[to] = chain.transition[from * num_labels + to] + next[to];
                pairs[from * num_labels + to] = alpha[(t - 1) * num_labels + from] + terms[to];
            }
            beta[from] = log_sum_exp(terms);
        }
        if (pair_counts.empty()) continue;
        const double pair_total = log_sum_exp(pairs);
        for (std::size_t k = 0; k < pairs.size(); ++k) pair_counts[k] += std::exp(pairs[k] - pair_total);
    }
    return log_partition;
}

std::vector<double> count_distribution(const Chain& chain, LabelId empty, std::span<const std::uint8_t> counted) {
    const int num_labels = chain.num_labels;
    const std::size_t num_positions = chain.num_positions();
    if (num_positions == 0) return {1.0};
    const std::vector<double> alpha = forward(chain);
    const auto counts = [&](std::size_t t) { return counted.empty() || counted[t] != 0; };
    std::size_t width = 1;
    for (std::size_t t = 0; t < num_positions; ++t) width += counts(t);
    // Row `label`: distribution of the count of a prefix, given that its last label is `label`.
    std::vector<double> given(num_labels * width), previous(num_labels * width), log_p(num_labels);
    std::size_t largest = 0;  // count that the prefix can have reached
    for (std::size_t t = 0; t < num_positions; ++t) {
        std::swap(given, previous);
        std::fill(given.begin(), given.end(), 0.0);
        largest += counts(t);
        for (int to = 0; to < num_labels; ++to) {
            if (!chain.allows(t, to)) continue;
            const std::size_t shift = counts(t) && to != empty;
            double* row = &given[to * width];
            if (t == 0) {
                row[shift] = 1.0;
                continue;
            }
            for (int from = 0; from < num_labels; ++from)
                log_p[from] = alpha[(t - 1) * num_labels + from] + chain.transition[from * num_labels + to];
            const double total = log_sum_exp(log_p);
            for (int from = 0; from < num_labels; ++from) {
                const double probability = std::exp(log_p[from] - total);
                const double* source = &previous[from * width];
                for (std::size_t k = 0; k + shift <= largest; ++k) row[k + shift] += probability * source[k];
            }
        }
    }
    const auto last = std::span(alpha).subspan((num_positions - 1) * num_labels, num_labels);
    const double log_partition = log_sum_exp(last);
    std::vector<double> distribution(width, 0.0);
    for (int label = 0; label < num_labels; ++label) {
        const double probability = std::exp(last[label] - log_partition);
        for (std::size_t k = 0; k < width; ++k) distribution[k] += probability * given[label * width + k];
    }
    return distribution;
}

}  // namespace explicable
