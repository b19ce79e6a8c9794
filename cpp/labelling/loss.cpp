#include "labelling/loss.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace explicable {
namespace {

void require(bool condition, const char* message) {
    if (!condition) throw std::invalid_argument(message);
}

void check_offsets(std::span<const std::int64_t> offsets, std::size_t num_values) {
    require(!offsets.empty() && offsets.front() == 0, "offsets must begin with 0");
    require(std::is_sorted(offsets.begin(), offsets.end()), "offsets must not decrease");
    require(offsets.back() == static_cast<std::int64_t>(num_values), "offsets must end with the number of entries");
}

// While no score is larger than this in absolute value, scaled probabilities stay above exp(-240) / num_labels and
// everything computed from them within 1e-183 and 1e183: far from underflow and overflow.
constexpr double kLargestScaledScore = 60.0;

// More labels than this, and larger scores, go through the passes in log space.
constexpr int kMostScaledLabels = 6;

// Forward and backward passes on probabilities, normalised at every position: no exponential in the inner loop,
// and what it works on fits into registers, since the number of labels is known when compiling.
template <int NumLabels>
class ScaledPass {
public:
    ScaledPass(std::span<const double> state, std::span<const double> transition)
        : potentials_(state.size() / NumLabels) {
        for (std::size_t k = 0; k < state.size(); ++k) potentials_[k / NumLabels][k % NumLabels] = std::exp(state[k]);
        for (std::size_t k = 0; k < transition_.size(); ++k) transition_[k] = std::exp(transition[k]);
    }

    // Returns the log partition function of one sequence and adds weight * expected counts to both gradients.
    // With Clamped, labels are summed over only where `clamped` has kAnyLabel.
    template <bool Clamped>
    double add_expected(std::span<const std::int32_t> rows, const LabelId* clamped, double weight,
                        std::span<double> state_gradient, std::span<double> transition_gradient) {
        const double log_partition = forward<Clamped>(rows, clamped);
        backward<Clamped>(rows, clamped, weight, state_gradient, transition_gradient);
        return log_partition;
    }

private:
    using Row = std::array<double, NumLabels>;

    template <bool Clamped>
    Row potentials(std::int32_t row, const LabelId* clamped, std::size_t t) const {
        Row result = potentials_[row];
        if (Clamped && clamped[t] != kAnyLabel)
            for (int j = 0; j < NumLabels; ++j)
                if (clamped[t] != j) result[j] = 0.0;
        return result;
    }

    template <bool Clamped>
    double forward(std::span<const std::int32_t> rows, const LabelId* clamped) {
        if (alpha_.size() < rows.size()) {
            alpha_.resize(rows.size());
            inverse_scale_.resize(rows.size());
        }
        const auto transition = transition_;
        Row before{};
        double log_partition = 0.0;
        double product = 1.0;
        for (std::size_t t = 0; t < rows.size(); ++t) {
            Row here = potentials<Clamped>(rows[t], clamped, t);
            if (t > 0)
                for (int to = 0; to < NumLabels; ++to) {
                    double incoming = 0.0;
                    for (int from = 0; from < NumLabels; ++from)
                        incoming += before[from] * transition[from * NumLabels + to];
                    here[to] *= incoming;
                }
            double sum = 0.0;
            for (const double weight : here) sum += weight;
            inverse_scale_[t] = 1.0 / sum;
            for (int j = 0; j < NumLabels; ++j) before[j] = here[j] / sum;
            alpha_[t] = before;
            product *= sum;
            if (product < 1e-30 || product > 1e30) {
                log_partition += std::log(product);
                product = 1.0;
            }
        }
        return log_partition + std::log(product);
    }

    template <bool Clamped>
    void backward(std::span<const std::int32_t> rows, const LabelId* clamped, double weight,
                  std::span<double> state_gradient, std::span<double> transition_gradient) const {
        const auto transition = transition_;
        std::array<double, NumLabels * NumLabels> pairs{};  // expected transitions, divided by `transition`
        Row beta;
        beta.fill(1.0);
        for (std::size_t t = rows.size(); t-- > 0;) {
            double* row_gradient = state_gradient.data() + static_cast<std::size_t>(rows[t]) * NumLabels;
            for (int j = 0; j < NumLabels; ++j) row_gradient[j] += weight * alpha_[t][j] * beta[j];
            if (t == 0) break;
            Row next = potentials<Clamped>(rows[t], clamped, t);
            for (int j = 0; j < NumLabels; ++j) next[j] *= beta[j] * inverse_scale_[t];
            const Row before = alpha_[t - 1];
            for (int from = 0; from < NumLabels; ++from) {
                double outgoing = 0.0;
                for (int to = 0; to < NumLabels; ++to) {
                    pairs[from * NumLabels + to] += before[from] * next[to];
                    outgoing += transition[from * NumLabels + to] * next[to];
                }
                beta[from] = outgoing;
            }
        }
        for (int k = 0; k < NumLabels * NumLabels; ++k)
            transition_gradient[k] += weight * pairs[k] * transition[k];
    }

    std::vector<Row> potentials_;  // exp(score) per row and label
    std::array<double, NumLabels * NumLabels> transition_;
    std::vector<Row> alpha_;
    std::vector<double> inverse_scale_;
};

bool are_at_most(std::span<const double> scores, double largest) {
    return std::all_of(scores.begin(), scores.end(), [&](double score) { return std::abs(score) <= largest; });
}

}  // namespace

void check_rows(const FeatureRows& rows, std::int64_t num_features) {
    check_offsets(rows.offsets, rows.features.size());
    require(rows.values.empty() || rows.values.size() == rows.features.size(), "one value is needed for each feature");
    require(std::all_of(rows.features.begin(), rows.features.end(),
                        [&](std::int32_t feature) { return feature >= 0 && feature < num_features; }),
            "feature numbers must be at least 0 and below the number of features");
    require(std::all_of(rows.values.begin(), rows.values.end(), [](double value) { return std::isfinite(value); }),
            "feature values must be finite");
}

void state_scores(const FeatureRows& rows, int num_labels, std::span<const double> weights, std::span<double> state) {
    std::fill(state.begin(), state.end(), 0.0);
    for (std::size_t row = 0; row < rows.size(); ++row) {
        double* scores = state.data() + row * num_labels;
        for (std::int64_t k = rows.offsets[row]; k < rows.offsets[row + 1]; ++k) {
            const double value = rows.values.empty() ? 1.0 : rows.values[k];
            const double* feature = weights.data() + static_cast<std::size_t>(rows.features[k]) * num_labels;
            for (int j = 0; j < num_labels; ++j) scores[j] += value * feature[j];
        }
    }
    require(are_usable_scores(state), "weights are not finite, or too large");
}

SequenceLoss::SequenceLoss(int num_labels, std::int64_t num_features, FeatureRows rows,
                           std::vector<std::int64_t> offsets, std::vector<std::int32_t> position_rows,
                           std::vector<LabelId> position_labels, std::vector<LabelId> position_given)
    : num_labels_(num_labels),
      num_features_(num_features),
      rows_(std::move(rows)),
      offsets_(std::move(offsets)),
      position_rows_(std::move(position_rows)),
      position_labels_(std::move(position_labels)),
      position_given_(std::move(position_given)) {
    require(num_labels >= 2 && num_labels <= 1 << 15, "there must be at least two labels");
    require(num_features >= 0 && num_features <= std::int64_t{1} << 31, "too many features");
    check_rows(rows_, num_features);
    check_offsets(offsets_, position_rows_.size());
    require(position_labels_.size() == position_rows_.size(), "one label is needed for each position");
    const auto num_rows = static_cast<std::int64_t>(rows_.size());
    require(std::all_of(position_rows_.begin(), position_rows_.end(),
                        [&](std::int32_t row) { return row >= 0 && row < num_rows; }),
            "row numbers must be at least 0 and below the number of rows");
    require(std::all_of(position_labels_.begin(), position_labels_.end(),
                        [&](LabelId label) { return label >= kAnyLabel && label < num_labels; }),
            "labels must be -1, or at least 0 and below the number of labels");
    require(position_given_.empty() || position_given_.size() == position_labels_.size(), "one given label is needed for each position, or none");
    for (std::size_t t = 0; t < position_given_.size(); ++t)
        require(position_given_[t] == kAnyLabel || position_given_[t] == position_labels_[t], "a given label must be that of the position");
    fully_observed_.reserve(num_sequences());
    for (std::size_t s = 0; s < num_sequences(); ++s)
        fully_observed_.push_back(std::none_of(position_labels_.begin() + offsets_[s],
                                               position_labels_.begin() + offsets_[s + 1],
                                               [](LabelId label) { return label == kAnyLabel; }));
}

std::size_t SequenceLoss::num_weights() const {
    return (static_cast<std::size_t>(num_features_) + num_labels_) * num_labels_;
}

double SequenceLoss::operator()(std::span<const double> weights, std::span<const double> sequence_weights,
                                std::span<double> gradient) const {
    require(weights.size() == num_weights() && gradient.size() == num_weights(), "wrong number of weights");
    require(sequence_weights.size() == num_sequences(), "one weight is needed for each sequence");
    require(std::all_of(weights.begin(), weights.end(), [](double w) { return std::isfinite(w); }) &&
                std::all_of(sequence_weights.begin(), sequence_weights.end(), [](double w) { return std::isfinite(w); }),
            "weights must be finite");
    const std::size_t num_state_weights = static_cast<std::size_t>(num_features_) * num_labels_;
    const auto transition = weights.subspan(num_state_weights);
    std::vector<double> state(rows_.size() * num_labels_), state_gradient(state.size(), 0.0);
    state_scores(rows_, num_labels_, weights.first(num_state_weights), state);
    std::fill(gradient.begin(), gradient.end(), 0.0);

    const bool fits_scaled_passes = num_labels_ <= kMostScaledLabels && are_at_most(state, kLargestScaledScore) &&
                                    are_at_most(transition, kLargestScaledScore);
    const auto transition_gradient = gradient.subspan(num_state_weights);
    const double loss = fits_scaled_passes
                            ? scaled(state, transition, sequence_weights, state_gradient, transition_gradient)
                            : in_log_space(state, transition, sequence_weights, state_gradient, transition_gradient);

    for (std::size_t row = 0; row < rows_.size(); ++row)
        for (std::int64_t k = rows_.offsets[row]; k < rows_.offsets[row + 1]; ++k) {
            const double value = rows_.values.empty() ? 1.0 : rows_.values[k];
            double* feature = gradient.data() + static_cast<std::size_t>(rows_.features[k]) * num_labels_;
            for (int j = 0; j < num_labels_; ++j) feature[j] += value * state_gradient[row * num_labels_ + j];
        }
    return loss;
}

// Score of the labels of a fully observed sequence; subtracts weight * its counts from the gradients.
double SequenceLoss::add_observed(std::size_t sequence, std::span<const double> state,
                                  std::span<const double> transition, double weight, std::span<double> state_gradient,
                                  std::span<double> transition_gradient) const {
    double score = 0.0;
    for (std::int64_t t = offsets_[sequence]; t < offsets_[sequence + 1]; ++t) {
        const std::size_t cell = static_cast<std::size_t>(position_rows_[t]) * num_labels_ + position_labels_[t];
        score += state[cell];
        state_gradient[cell] -= weight;
        if (t == offsets_[sequence]) continue;
        const std::size_t pair = static_cast<std::size_t>(position_labels_[t - 1]) * num_labels_ + position_labels_[t];
        score += transition[pair];
        transition_gradient[pair] -= weight;
    }
    return score;
}

double SequenceLoss::scaled(std::span<const double> state, std::span<const double> transition,
                            std::span<const double> sequence_weights, std::span<double> state_gradient,
                            std::span<double> transition_gradient) const {
    const auto sum = [&](auto pass) {
        double loss = 0.0;
        for (std::size_t s = 0; s < num_sequences(); ++s) {
            const double weight = sequence_weights[s];
            const std::size_t length = offsets_[s + 1] - offsets_[s];
            if (weight == 0.0 || length == 0) continue;
            const auto rows = std::span(position_rows_).subspan(offsets_[s], length);
            const LabelId* labels = position_labels_.data() + offsets_[s];
            loss += weight * (position_given_.empty()
                                  ? pass.template add_expected<false>(rows, nullptr, weight, state_gradient,
                                                                      transition_gradient)
                                  : pass.template add_expected<true>(rows, position_given_.data() + offsets_[s], weight,
                                                                     state_gradient, transition_gradient));
            loss -= weight * (fully_observed_[s]
                                  ? add_observed(s, state, transition, weight, state_gradient, transition_gradient)
                                  : pass.template add_expected<true>(rows, labels, -weight, state_gradient,
                                                                     transition_gradient));
        }
        return loss;
    };
    switch (num_labels_) {
        case 2: return sum(ScaledPass<2>(state, transition));
        case 3: return sum(ScaledPass<3>(state, transition));
        case 4: return sum(ScaledPass<4>(state, transition));
        case 5: return sum(ScaledPass<5>(state, transition));
        default: return sum(ScaledPass<kMostScaledLabels>(state, transition));
    }
}

double SequenceLoss::in_log_space(std::span<const double> state, std::span<const double> transition,
                                  std::span<const double> sequence_weights, std::span<double> state_gradient,
                                  std::span<double> transition_gradient) const {
    double loss = 0.0;
    std::vector<double> scores, expected, pairs(transition.size());
    for (std::size_t s = 0; s < num_sequences(); ++s) {
        const double weight = sequence_weights[s];
        const std::size_t length = offsets_[s + 1] - offsets_[s];
        if (weight == 0.0 || length == 0) continue;
        const auto rows = std::span(position_rows_).subspan(offsets_[s], length);
        const auto labels = std::span(position_labels_).subspan(offsets_[s], length);
        scores.clear();
        for (const std::int32_t row : rows) {
            const auto row_scores = state.subspan(static_cast<std::size_t>(row) * num_labels_, num_labels_);
            scores.insert(scores.end(), row_scores.begin(), row_scores.end());
        }
        expected.resize(scores.size());
        const auto add = [&](std::span<const LabelId> clamped, double signed_weight) {
            std::fill(pairs.begin(), pairs.end(), 0.0);
            const double log_partition = marginals({num_labels_, scores, transition, clamped}, expected, pairs);
            for (std::size_t t = 0; t < length; ++t)
                for (int j = 0; j < num_labels_; ++j)
                    state_gradient[static_cast<std::size_t>(rows[t]) * num_labels_ + j] +=
                        signed_weight * expected[t * num_labels_ + j];
            for (std::size_t k = 0; k < pairs.size(); ++k) transition_gradient[k] += signed_weight * pairs[k];
            return log_partition;
        };
        const auto given = std::span(position_given_).subspan(position_given_.empty() ? 0 : offsets_[s], position_given_.empty() ? 0 : length);
        loss += weight * (add(given, weight) - add(labels, -weight));
    }
    return loss;
}

}  // namespace explicable
