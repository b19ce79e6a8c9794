// A labeller compiled for one team task: scores path # relaxed plan in time that does not depend on the path.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <ranges>
#include <span>
#include <vector>

#include "labelling/feature_weights.hpp"
#include "labelling/human_choices.hpp"
#include "labelling/step_memory.hpp"
#include "labelling/tally.hpp"
#include "labelling/team_tables.hpp"
#include "search/path_scorer.hpp"

namespace explicable {

inline std::uint64_t combine(std::uint64_t key, std::uint64_t value) {  // splitmix64 of both
    key += value + 0x9E3779B97F4A7C15u;
    key = (key ^ (key >> 30)) * 0xBF58476D1CE4E5B9u;
    key = (key ^ (key >> 27)) * 0x94D049BB133111EBu;
    return key ^ (key >> 31);
}

inline constexpr int kMaxRequests = 8;  // a person keeps so many open requests in mind; older ones are forgotten
inline constexpr int kRecentSteps = 4;  // steps of robots that a later one may take back
inline constexpr double kExplicable = -std::numeric_limits<double>::infinity();  // score of a human step, explicable by definition

using RobotSteps = std::array<OperatorId, kRecentSteps>;  // the latest first

// What the features of the next step need of the steps before it.
struct Situation {
    OperatorId last = -1, last_human = -1;
    std::int32_t num_open = 0;
    std::array<std::int32_t, kMaxRequests> open{};          // requests, the latest last
    RobotSteps robot_steps{-1, -1, -1, -1};
    std::int32_t neighbour = kNothing;                      // `last` as the next step sees it

    std::span<const std::int32_t> requests() const { return std::span(open).first(static_cast<std::size_t>(num_open)); }
    int request() const { return num_open == 0 ? -1 : open[static_cast<std::size_t>(num_open) - 1]; }
};

class Scorer : public PathScorer {
public:
    using Transitions = std::array<std::array<double, 2>, 2>;  // label before x label after; 0 explicable, 1 not

    // `own`: a score for each operator, added to that of its features; or none.
    Scorer(const Task& task, std::shared_ptr<const TeamTables> tables, const FeatureWeights& weights,
           std::vector<double> own, Transitions transitions, bool expected);

    bool fits(const Task& task) const override { return &task == &task_; }
    std::size_t context_size() const override;
    void root(const State& state, std::byte* context) const override;
    void extend(const std::byte* parent, OperatorId step, const State& before, const State& after,
                std::byte* context) const override;
    PathScore score(const std::byte* context, const State& state,
                    std::span<const OperatorId> relaxed_plan) const override;
    std::unique_ptr<Counter> counter() const override;
    std::uint64_t closing_key(const std::byte* context) const override;
    double lead(const std::byte* a, const std::byte* b, const State& state) const override;
    double charge(const std::byte* context) const override { return read(context).charge; }
    bool charges() const override { return choices_ != nullptr; }
    void add_charge(std::byte* context, double charge) const;
    bool has_bounds() const override { return true; }
    double least_count(const std::byte* context) const override;
    double least_growth(const std::byte* parent, OperatorId step, const std::byte* child) const override;
    double least_end(const std::byte* context) const override;
    std::uint64_t outlook_key(const std::byte* context) const override;
    void widen(std::byte* context, const std::byte* other) const override;

    // Whether bytes from outside can be a context of this scorer.
    bool is_sound(std::span<const std::byte> context) const;
    // Makes every path begin with the steps that led to a (sound) context.
    void start_at(std::span<const std::byte> context);
    // From now on paths are charged for what the human does: `price` for each nat of surprise.
    void charge_for(std::shared_ptr<const HumanChoices> choices, const HumanWeights& weights, double price);

private:
    class RememberingCounter;
    struct Span {
        double least, greatest;
        void cover(double value) {
            least = std::min(least, value);
            greatest = std::max(greatest, value);
        }
    };
    // The labels of the steps whose features are final. Of two labels only the difference counts.
    struct Chain {
        double odds = 0;                    // hard: best score of inexplicable - explicable; soft: P(inexplicable)
        std::array<double, 2> count{};      // inexplicable steps so far, given the label of the last
        std::array<double, 2> variance{};
        bool is_empty = true;
    };
    // What a step and the step before it, side by side, add to the scores of the two.
    struct alignas(16) Pair {
        double of_step = 0, of_last = 0;
        Pair& operator+=(const Pair& other) {
            of_step += other.of_step;
            of_last += other.of_last;
            return *this;
        }
        Pair& operator*=(const Pair& other) {
            return *this = std::bit_cast<Pair>(std::bit_cast<Two>(*this) * std::bit_cast<Two>(other));
        }
        bool operator==(const Pair&) const = default;
    };
    // Weights of equal arguments: for each argument of a step, a sum for each set of four arguments of the other step that may
    // equal it. Step schemas that have none share a block of zeros, the first.
    template <class Weight>
    class EqualityWeights {
    public:
        // `weight(step, other, i, j)`: of argument i of schema `step` being argument j of schema `other`.
        template <class F>
        EqualityWeights(const TeamTables& tables, F weight);
        Weight of(const TeamStep& step, const TeamStep& other) const {
            Weight sum{};
            for_equal(step, other, [&sum](const Weight& weight) { sum += weight; });
            return sum;
        }
        // Calls `use` with the weights that add up to what of() is.
        template <class F>
        void for_equal(const TeamStep& step, const TeamStep& other, F use) const;
        // The same of each weight; `f` of none must change nothing.
        template <class F>
        EqualityWeights map(F f) const {
            EqualityWeights mapped = *this;
            std::ranges::transform(sums_, mapped.sums_.begin(), f);
            return mapped;
        }
        // No more than this is the greatest sum of what `size` makes of each weight.
        template <class F>
        double most(F size) const;
        // Of argument i of schema `step` being argument j of schema `other`.
        const Weight& weight(std::size_t step, std::size_t other, std::size_t i, std::size_t j) const {
            return sums_[block_[step * width_ + other] + (i * halves_ + j / 4) * kSets + (std::size_t{1} << j % 4)];
        }
        bool any() const { return std::ranges::any_of(block_, [](std::uint32_t block) { return block != 0; }); }

    private:
        static constexpr std::size_t kSets = 16;
        std::size_t block_size() const { return rows_ * halves_ * kSets; }
        std::size_t width_, rows_, halves_;  // schemas and none; arguments; sets of four arguments
        std::vector<std::uint32_t> block_;   // schema of a step, of the other
        std::vector<Weight> sums_;           // block, argument, half, set
    };
    struct Context {
        Situation situation;
        Chain chain;         // all steps but the last
        double pending = 0;  // score of the last step, but for its look-ahead; kExplicable for a human's
        double charge = 0;   // for what the human has done
        std::int32_t num_steps = 0;
    };
    static Context read(const std::byte* bytes) {
        Context context;
        std::memcpy(&context, bytes, sizeof context);
        return context;
    }
    std::uint64_t situation_key(const Context& context) const;
    void sum_up(const FeatureWeights& weights);
    void find_odds();
    void find_bounds();
    double from_right(double z) const;
    Span from_last(const Context& context) const;
    double least_inexplicable(const Context& context, double look_ahead, double heard) const;
    double lead_expected(const Chain& a, const Chain& b, const Span& right, const Span& ahead) const;
    double lead_best(const Chain& a, const Chain& b, const Span& right) const;
    Span look_ahead_span(const Situation& situation) const;
    double effect_of_history(const Situation& a, const Situation& b) const;
    template <class Labels>
    void advance(Context& context, Labels& labels, OperatorId step, const OpenGoals& goals) const;
    template <class Labels>
    void walk(Context& context, Labels& labels, const State& state, std::span<const OperatorId> relaxed_plan) const;
    // Inexplicable steps; `step`, or -1, is taken while goals are open, and leads to the state.
    double count_after(Context context, OperatorId step, const OpenGoals& goals, const State& state,
                       std::span<const OperatorId> relaxed_plan) const;
    // What a step adds to the scores, but for what it takes back.
    struct StepScore {
        double of_last, of_step;
        int neighbour;  // how the steps beside it see it
    };
    StepScore judge(const Situation& situation, OperatorId step, const OpenGoals& goals) const;
    // What a robot's step scores but for what it shares with the steps beside it; `neighbour` is how they see it.
    double own_score(const Situation& situation, OperatorId step, const OpenGoals& goals, int& neighbour) const;
    // Of what two steps are; `next` may be -1: the end.
    Pair pair_score(OperatorId last, OperatorId next) const;
    std::size_t place_of_schemas(const TeamStep& step, const TeamStep& last) const {
        return static_cast<std::size_t>(step.schema) * (num_schemas_ + 1) + static_cast<std::size_t>(last.schema);
    }
    // Of how they see each other.
    static std::size_t place_of(int neighbour, int neighbour_of_last) {
        return static_cast<std::size_t>(neighbour) * kNumNeighbours + static_cast<std::size_t>(neighbour_of_last);
    }
    // Of both: of the last step and of `next`.
    Pair side_by_side(const Situation& situation, OperatorId next, int neighbour) const {
        Pair pair = pair_score(situation.last, next);
        return pair += beside_[place_of(neighbour, situation.neighbour)];
    }
    double look_ahead(const Situation& situation, OperatorId next, int neighbour) const {
        return side_by_side(situation, next, neighbour).of_last;
    }
    double taking_back(const RobotSteps& recent, OperatorId step) const;
    bool fulfils_open(const Situation& situation, OperatorId step) const;
    void remember(Situation& situation, OperatorId step, int neighbour) const;
    void remember_requests(Situation& situation, OperatorId step) const;
    void withdraw_requests(Situation& situation, const State& state) const;
    void append(Chain& chain, double score) const;
    void append_best(Chain& chain, double score) const;
    void append_expected(Chain& chain, double score) const;
    template <int kPowers>
    void append(Tally<kPowers>& tally, double score) const {
        tally.append(factors_, score);
    }
    template <int kPowers>
    static Tally<kPowers> tally_of(const Chain& chain) {
        return {chain.odds, chain.count, chain.variance, chain.is_empty};
    }
    bool is_human(OperatorId step) const { return tables_->marks(step).is_human; }
    std::size_t schema_of(OperatorId step) const { return static_cast<std::size_t>((*tables_)[step].schema); }

    Context start_;
    const Task& task_;
    std::shared_ptr<const TeamTables> tables_;
    // Weights, those that are always added together summed up beforehand. Kinds of progress are indexed as they are coded.
    static constexpr std::size_t kCodes = 16;  // of a kind of progress
    std::vector<double> own_;              // operator; empty if no operator has a score of its own
    std::vector<double> alone_;            // schema, whether the mental task has the step
    std::vector<double> undoes_, returns_; // schema
    std::vector<double> request_;          // schema, progress in both models
    std::vector<double> goals_;            // schema, progress of the mission, and toward the nearest in both models
    std::vector<double> request_mission_;  // both kinds of progress
    std::vector<Pair> schemas_;            // schema of a step, or none; of the step before, or none
    std::vector<Pair> beside_;             // what the step after, the step before is to its neighbour
    EqualityWeights<Pair> same_;           // step and step before
    EqualityWeights<double> same_human_;   // step and last human step
    // The same of pairs as odds, if none are too large.
    bool has_odds_ = false;
    std::vector<Pair> odds_of_schemas_, odds_beside_;
    EqualityWeights<Pair> odds_of_same_;
    std::shared_ptr<StepMemories> memories_;  // copies have the same weights
    std::shared_ptr<const HumanChoices> choices_;  // none: nothing is charged
    HumanWeights human_weights_{};
    double price_of_surprise_ = 0;
    Transitions transitions_;
    Transitions factors_;  // exp of the transitions, the largest scaled to 1
    std::size_t num_schemas_;
    bool expected_, uses_returns_, uses_human_;
    // What neighbours can say, in log odds of "inexplicable": the label before a step; the label after it, of a robot's step
    // and of a human's, which is always explicable.
    Span from_before_{}, from_robot_{};
    double from_human_ = 0;
    bool is_attractive_ = true;  // like labels like to stand together
    double coupling_ = 0;        // how far a label can move the expectation of its neighbour's, all else fixed
    double returns_least_ = 0, returns_effect_ = 0;
    std::vector<Span> look_;  // schema of a step: its look-ahead features but for `outlook`
    std::array<Span, kNumNeighbours> outlook_{};
};

template <class Weight>
template <class F>
Scorer::EqualityWeights<Weight>::EqualityWeights(const TeamTables& tables, F weight)
    : width_(static_cast<std::size_t>(tables.num_schemas) + 1),
      rows_(std::min(tables.max_arity, kMaxArguments)),
      halves_(rows_ > 4 ? 2 : 1),
      block_(width_ * width_),
      sums_(std::max<std::size_t>(block_size(), 1)) {
    const std::size_t num_schemas = width_ - 1;
    std::vector<Weight> block;
    for (std::size_t step = 0; step < num_schemas; ++step) {
        for (std::size_t other = 0; other < num_schemas; ++other) {
            block.clear();
            for (std::size_t i = 0; i < std::min(tables.arity[step], kMaxArguments); ++i) {
                for (std::size_t j = 0; j < std::min(tables.arity[other], kMaxArguments); ++j) {
                    const Weight one = weight(step, other, i, j);
                    if (one == Weight{}) continue;
                    block.resize(block_size());
                    for (std::size_t set = 0; set < kSets; ++set)
                        if (set >> j % 4 & 1) block[(i * halves_ + j / 4) * kSets + set] += one;
                }
            }
            if (block.empty()) continue;
            block_[step * width_ + other] = static_cast<std::uint32_t>(sums_.size());
            sums_.insert(sums_.end(), block.begin(), block.end());
        }
    }
}

template <class Weight>
template <class F>
inline void Scorer::EqualityWeights<Weight>::for_equal(const TeamStep& step, const TeamStep& other, F use) const {
    const auto block = block_[static_cast<std::size_t>(step.schema) * width_ + static_cast<std::size_t>(other.schema)];
    if (block == 0) return;
    const Weight* sums = sums_.data() + block;
    for (std::size_t i = 0; i < rows_; ++i, sums += kSets) {
        use(sums[equal_in_four(step.arguments[i], other.arguments.data())]);
        if (halves_ > 1) use((sums += kSets)[equal_in_four(step.arguments[i], other.arguments.data() + 4)]);
    }
}

template <class Weight>
template <class F>
double Scorer::EqualityWeights<Weight>::most(F size) const {
    double most = 0;
    for (auto block = sums_.begin(); block_size() > 0 && block != sums_.end(); block += static_cast<std::ptrdiff_t>(block_size())) {
        double sum = 0;
        for (auto four = block; four != block + static_cast<std::ptrdiff_t>(block_size()); four += kSets)
            sum += std::ranges::max(std::span(four, kSets) | std::views::transform(size));
        most = std::max(most, sum);
    }
    return most;
}

}  // namespace explicable
