#include "labelling/scorer.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace explicable {
namespace {

constexpr double kImpossible = -std::numeric_limits<double>::infinity();

void read_goals(const Task& task, const TeamTables& tables, const State& state, OpenGoals& goals) {
    for (std::size_t goal = 0; goal < tables.goals.size(); ++goal)
        if (state.holds(task, tables.goals[goal])) goals.close(goal);
}

bool any(const std::vector<double>& weights) {
    return std::ranges::any_of(weights, [](double weight) { return weight != 0; });
}

}  // namespace

Scorer::Scorer(const Task& task, std::shared_ptr<const TeamTables> tables, const FeatureWeights& weights,
               std::vector<double> own, Transitions transitions, bool expected)
    : task_(task),
      tables_(std::move(tables)),
      after_(weights.of(Template::kAfter)),
      before_(weights.of(Template::kBefore)),
      same_after_(weights.of(Template::kSameAfter)),
      same_before_(weights.of(Template::kSameBefore)),
      same_human_(weights.of(Template::kSameHuman)),
      undoes_(weights.of(Template::kUndoes)),
      returns_(weights.of(Template::kReturns)),
      unbelieved_(weights.of(Template::kUnbelieved)),
      own_(std::move(own)),
      request_mission_(weights.of(Template::kRequestMission)),
      trend_(weights.of(Template::kTrend)),
      outlook_(weights.of(Template::kOutlook)),
      transitions_(transitions),
      factors_(),
      num_schemas_(static_cast<std::size_t>(tables_->num_schemas)),
      expected_(expected),
      uses_returns_(any(returns_)),
      uses_human_(any(same_human_)) {
    constexpr std::size_t n = kNumProgress;
    for (std::size_t schema = 0; schema < num_schemas_; ++schema) {
        for (std::size_t last = 0; last <= num_schemas_; ++last)
            after_[schema * (num_schemas_ + 1) + last] += weights.of(Template::kStep)[schema];
        for (std::size_t mental = 0; mental < n; ++mental) {
            for (std::size_t own = 0; own < n; ++own) {
                request_.push_back(weights.of(Template::kRequestMental)[schema * n + mental] +
                                   weights.of(Template::kRequestOwn)[schema * n + own] +
                                   weights.of(Template::kRequestModels)[mental * n + own]);
                for (std::size_t mission = 0; mission < n; ++mission)
                    goals_.push_back(weights.of(Template::kGoalMental)[schema * n + mental] +
                                     weights.of(Template::kGoalOwn)[schema * n + own] +
                                     weights.of(Template::kMission)[schema * n + mission]);
            }
        }
    }
    if (!own_.empty() && own_.size() != static_cast<std::size_t>(tables_->num_operators()))
        throw std::invalid_argument("one score an operator is needed, or none");
    if (!std::ranges::all_of(own_, [](double score) { return std::isfinite(score); }))
        throw std::invalid_argument("a score is not finite");
    double largest = kImpossible;
    for (const auto& row : transitions)
        for (const auto transition : row) {
            if (!(std::abs(transition) <= 300)) throw std::invalid_argument("a transition weight is beyond 300");
            largest = std::max(largest, transition);
        }
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t j = 0; j < 2; ++j) factors_[i][j] = std::exp(transitions[i][j] - largest);
    find_bounds();
}

std::size_t Scorer::context_size() const { return sizeof(Context); }

void Scorer::root(const State&, std::byte* context) const {
    static_assert(std::is_trivially_copyable_v<Context>);
    std::memcpy(context, &start_, sizeof start_);
}

void Scorer::extend(const std::byte* parent, OperatorId step, const State& before, const State& after,
                    std::byte* child) const {
    Context context;
    std::memcpy(&context, parent, sizeof context);
    if (tables_->schema[step] >= 0) {
        OpenGoals goals(tables_->goals.size());
        read_goals(task_, *tables_, before, goals);
        advance(context, step, goals);
        // A request whose fact is gone has been withdrawn.
        auto& situation = context.situation;
        std::int32_t kept = 0;
        for (std::int32_t i = 0; i < situation.num_open; ++i)
            if (tables_->stands(task_, after, situation.open[i])) situation.open[kept++] = situation.open[i];
        std::fill(situation.open.begin() + kept, situation.open.end(), 0);
        situation.num_open = kept;
    }
    std::memcpy(child, &context, sizeof context);
}

PathScore Scorer::score(const std::byte* node, const State& state, std::span<const OperatorId> relaxed_plan) const {
    Context context;
    std::memcpy(&context, node, sizeof context);
    if (!relaxed_plan.empty()) {
        OpenGoals goals(tables_->goals.size());
        read_goals(task_, *tables_, state, goals);
        for (const auto step : relaxed_plan) {
            if (tables_->schema[step] < 0) continue;
            advance(context, step, goals);
            for (const auto goal : tables_->achieves[step]) goals.close(static_cast<std::size_t>(goal));
        }
    }
    if (context.num_steps == 0) return {0, 0, 0};
    const auto& situation = context.situation;
    const bool human = is_human(situation.last);
    const double last = human ? 0 : context.pending + look_ahead(situation, -1, kNothing);
    append(context.chain, human, last);
    const auto& chain = context.chain;
    if (!expected_) {
        const auto best = static_cast<std::size_t>(chain.odds > 0);
        return {chain.count[best], 0, context.num_steps};
    }
    const double p = chain.odds, mean = (1 - p) * chain.count[0] + p * chain.count[1];
    const double spread = chain.count[1] - chain.count[0];
    const double variance = (1 - p) * chain.variance[0] + p * chain.variance[1] + p * (1 - p) * spread * spread;
    return {mean, variance, context.num_steps};
}

std::uint64_t Scorer::closing_key(const std::byte* node) const { return situation_key(read(node)); }

// What the features of later steps see of the path, but for steps that they may take back; see effect_of_history().
std::uint64_t Scorer::situation_key(const Context& context) const {
    const auto& situation = context.situation;
    std::uint64_t key = static_cast<std::uint64_t>(context.num_steps > 0);
    const auto add = [&key](std::int64_t value) { key = combine(key, static_cast<std::uint64_t>(value)); };
    add(situation.last);
    if (uses_human_) add(situation.last_human);
    for (std::int32_t i = 0; i < situation.num_open; ++i) add(situation.open[i]);
    add(situation.robot_steps[0]);
    add(situation.neighbour);
    return key;
}

bool Scorer::is_sound(std::span<const std::byte> bytes) const {
    if (bytes.size() != sizeof(Context)) return false;
    Context context;
    std::memcpy(&context, bytes.data(), sizeof context);
    const auto& situation = context.situation;
    const auto is_step = [this](OperatorId step) { return step >= -1 && step < tables_->num_operators(); };
    const auto is_request = [this](std::int32_t request) { return request >= 0 && request < tables_->num_requests(); };
    return context.num_steps >= 0 && (context.num_steps > 0) == (situation.last >= 0) && is_step(situation.last) &&
           is_step(situation.last_human) && situation.num_open >= 0 && situation.num_open <= kMaxRequests &&
           std::all_of(situation.open.begin(), situation.open.begin() + situation.num_open, is_request) &&
           std::ranges::all_of(situation.robot_steps, is_step) && situation.neighbour >= 0 &&
           situation.neighbour < kNumNeighbours;
}

void Scorer::start_at(std::span<const std::byte> context) { std::memcpy(&start_, context.data(), sizeof start_); }

// Makes the features of the last step final, now that the next is known, and takes in the next.
void Scorer::advance(Context& context, OperatorId step, const OpenGoals& goals) const {
    auto& situation = context.situation;
    int neighbour = kHumanStep;
    const double score = is_human(step) ? 0 : step_score(situation, step, goals, neighbour);
    if (context.num_steps > 0) {
        const bool human = is_human(situation.last);
        append(context.chain, human, human ? 0 : context.pending + look_ahead(situation, step, neighbour));
    }
    context.pending = score;
    ++context.num_steps;
    remember(situation, step, neighbour);
}

double Scorer::step_score(const Situation& situation, OperatorId step, const OpenGoals& goals, int& neighbour) const {
    const auto& tables = *tables_;
    const auto me = static_cast<std::size_t>(tables.schema[step]);
    double score = after_[me * (num_schemas_ + 1) + schema_of(situation.last)];
    if (situation.last >= 0) score += equality_score(same_after_, step, situation.last);
    if (uses_human_ && situation.last_human >= 0) score += equality_score(same_human_, step, situation.last_human);
    const auto& recent = situation.robot_steps;
    const auto takes_back = [&](OperatorId earlier) { return tables.takes_back(step, earlier); };
    if (takes_back(recent[0]))
        score += undoes_[me];
    else if (uses_returns_ && std::any_of(recent.begin() + 1, recent.end(), takes_back))
        score += returns_[me];
    if (!tables.in_mental[step]) score += unbelieved_[me];
    if (!own_.empty()) score += own_[static_cast<std::size_t>(step)];

    auto request = tables.toward_request(step, situation.request());
    if (request.mental != Progress::kDone && fulfils_open(situation, step))
        request = {Progress::kDoneOther, Progress::kDoneOther};
    const auto goal = tables.toward_goals(step, goals);
    constexpr std::size_t n = kNumProgress;
    const auto mental = static_cast<std::size_t>(request.mental), own = static_cast<std::size_t>(request.own);
    const auto mission = static_cast<std::size_t>(goal.mission);
    const auto nearest = static_cast<std::size_t>(goal.mental) * n + static_cast<std::size_t>(goal.own);
    score += request_[(me * n + mental) * n + own] + goals_[(me * n * n + nearest) * n + mission] +
             request_mission_[mental * n + mission] +
             trend_[mental * kNumNeighbours + static_cast<std::size_t>(situation.neighbour)];
    neighbour = static_cast<int>(mental);
    return score;
}

bool Scorer::fulfils_open(const Situation& situation, OperatorId step) const {
    const auto open = std::span(situation.open).first(static_cast<std::size_t>(situation.num_open));
    for (const auto request : tables_->fulfils[step])
        if (std::ranges::find(open, request) != open.end()) return true;
    return false;
}

// A feature for every argument of `step` that equals an argument of `other`.
double Scorer::equality_score(const std::vector<double>& weights, OperatorId step, OperatorId other) const {
    const auto count = std::min(tables_->max_arity, kMaxArguments);
    const double* const pairs = weights.data() + (schema_of(step) * num_schemas_ + schema_of(other)) * count * count;
    double score = 0;
    for (auto equal = tables_->equal_arguments(step, other); equal != 0; equal &= equal - 1) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(equal));
        score += pairs[bit / kMaxArguments * count + bit % kMaxArguments];
    }
    return score;
}

// The features of the last step, a robot's, that see the step after it.
double Scorer::look_ahead(const Situation& situation, OperatorId next, int neighbour) const {
    return before_[schema_of(situation.last) * (num_schemas_ + 1) + schema_of(next)] +
           (next < 0 ? 0 : equality_score(same_before_, situation.last, next)) +
           outlook_[static_cast<std::size_t>(situation.neighbour) * kNumNeighbours + static_cast<std::size_t>(neighbour)];
}

void Scorer::remember(Situation& situation, OperatorId step, int neighbour) const {
    situation.last = step;
    situation.neighbour = neighbour;
    auto& open = situation.open;
    auto& count = situation.num_open;
    const auto close = [&](std::int32_t request) {
        const auto end = open.begin() + count;
        const auto kept = std::remove(open.begin(), end, request);
        std::fill(kept, end, 0);
        count = static_cast<std::int32_t>(kept - open.begin());
    };
    if (!is_human(step)) {
        std::shift_right(situation.robot_steps.begin(), situation.robot_steps.end(), 1);
        situation.robot_steps[0] = step;
        for (const auto request : tables_->fulfils[step]) close(request);
        return;
    }
    situation.last_human = step;
    const auto request = tables_->asks_for[step];
    if (request < 0) return;
    close(request);
    if (count == kMaxRequests) {
        std::shift_left(open.begin(), open.end(), 1);
        --count;
    }
    open[static_cast<std::size_t>(count++)] = request;
}

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

}  // namespace explicable
