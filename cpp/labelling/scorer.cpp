#include "labelling/scorer.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

namespace explicable {
namespace {

constexpr double kImpossible = -std::numeric_limits<double>::infinity();

// Goals of a state on the stack, unless there are unusually many.
class GoalMask {
public:
    GoalMask(const Task& task, const TeamTables& tables, const State& state) {
        const auto count = tables.goals.size();
        if (count > small_.size()) large_.resize(count);
        mask_ = std::span(count > small_.size() ? large_.data() : small_.data(), count);
        for (std::size_t goal = 0; goal < count; ++goal)
            mask_[goal] = state.holds(task, tables.goals[goal]) ? kNoWay : Distance{0};
    }
    GoalMask(const GoalMask&) = delete;
    std::span<Distance> mask() { return mask_; }

private:
    std::array<Distance, 64> small_;
    std::vector<Distance> large_;
    std::span<Distance> mask_;
};

std::uint64_t combine(std::uint64_t key, std::uint64_t value) {  // splitmix64 of both
    key += value + 0x9E3779B97F4A7C15u;
    key = (key ^ (key >> 30)) * 0xBF58476D1CE4E5B9u;
    key = (key ^ (key >> 27)) * 0x94D049BB133111EBu;
    return key ^ (key >> 31);
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value == 0 ? 0.0 : value); }

}  // namespace

FeatureWeights::FeatureWeights(int num_schemas, int max_arity) {
    const auto schemas = static_cast<std::size_t>(num_schemas), neighbours = schemas + 1;  // or nothing
    const auto arity = static_cast<std::size_t>(max_arity);
    const std::size_t progress = kNumProgress, beside = kNumNeighbours;
    const std::vector<std::vector<std::size_t>> dimensions = {
        {schemas},                            // step
        {schemas, neighbours},                // after
        {schemas, neighbours},                // before
        {schemas, schemas, arity, arity},     // same as after
        {schemas, schemas, arity, arity},     // same as before
        {schemas, schemas, arity, arity},     // same as the last human step
        {schemas},                            // undoes
        {schemas},                            // returns
        {schemas},                            // unbelieved
        {schemas, progress},                  // request, mental
        {schemas, progress},                  // request, own
        {schemas, progress},                  // nearest goal, mental
        {schemas, progress},                  // nearest goal, own
        {schemas, progress},                  // mission
        {progress, progress},                 // request, mental and own
        {progress, progress},                 // request and mission
        {progress, beside},                   // trend
        {progress, beside},                   // outlook
    };
    std::size_t offset = 0;
    for (const auto& sizes : dimensions) {
        Layout layout{.offset = offset, .size = 1, .dimensions = sizes, .strides = {}};
        for (std::size_t i = sizes.size(); i-- > 0;) {
            layout.strides[i] = layout.size;
            if (sizes[i] != 0 && layout.size > (std::size_t{1} << 28) / sizes[i])
                throw std::length_error("too many schemas or parameters for a table of weights");
            layout.size *= sizes[i];
        }
        offset += layout.size;
        layouts_.push_back(std::move(layout));
    }
    weights_.assign(offset, 0.0);
}

void FeatureWeights::set(int feature_template, std::span<const std::int32_t> values, double weight) {
    if (feature_template < 0 || feature_template >= kNumTemplates) throw std::invalid_argument("no such template");
    const auto& layout = layouts_[static_cast<std::size_t>(feature_template)];
    if (values.size() < layout.dimensions.size()) throw std::invalid_argument("a feature has too few values");
    if (!std::isfinite(weight)) throw std::invalid_argument("a weight is not finite");
    std::size_t index = layout.offset;
    for (std::size_t i = 0; i < layout.dimensions.size(); ++i) {
        if (values[i] < 0 || static_cast<std::size_t>(values[i]) >= layout.dimensions[i])
            throw std::invalid_argument("a value of a feature is out of range");
        index += layout.strides[i] * static_cast<std::size_t>(values[i]);
    }
    weights_[index] = weight;
}

bool FeatureWeights::any(Template feature_template) const {
    const auto& layout = layouts_[static_cast<std::size_t>(feature_template)];
    const std::span all(weights_.data() + layout.offset, layout.size);
    return std::ranges::any_of(all, [](double weight) { return weight != 0; });
}

Scorer::Scorer(const Task& task, std::shared_ptr<const TeamTables> tables, FeatureWeights weights,
               Transitions transitions, bool expected)
    : task_(task),
      tables_(std::move(tables)),
      weights_(std::move(weights)),
      transitions_(transitions),
      factors_(),
      expected_(expected),
      uses_returns_(weights_.any(Template::kReturns)),
      uses_human_(weights_.any(Template::kSameHuman)) {
    double largest = kImpossible;
    for (const auto& row : transitions)
        for (const auto transition : row) {
            if (!(std::abs(transition) <= 300)) throw std::invalid_argument("a transition weight is beyond 300");
            largest = std::max(largest, transition);
        }
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) factors_[i][j] = std::exp(transitions[i][j] - largest);
}

std::size_t Scorer::context_size() const { return sizeof(Context); }

void Scorer::root(const State&, std::byte* context) const {
    static_assert(std::is_trivially_copyable_v<Context>);
    const Context fresh;
    std::memcpy(context, &fresh, sizeof fresh);
}

void Scorer::extend(const std::byte* parent, OperatorId step, const State& before, const State& after,
                    std::byte* child) const {
    Context context;
    std::memcpy(&context, parent, sizeof context);
    if (tables_->schema[step] >= 0) {
        GoalMask goals(task_, *tables_, before);
        advance(context, step, goals.mask());
        // A request whose fact is gone has been withdrawn.
        auto& situation = context.situation;
        std::int32_t kept = 0;
        for (std::int32_t i = 0; i < situation.num_open; ++i)
            if (after.holds(task_, tables_->request_facts[situation.open[i]])) situation.open[kept++] = situation.open[i];
        std::fill(situation.open.begin() + kept, situation.open.end(), 0);
        situation.num_open = kept;
    }
    std::memcpy(child, &context, sizeof context);
}

PathScore Scorer::score(const std::byte* node, const State& state, std::span<const OperatorId> relaxed_plan) const {
    Context context;
    std::memcpy(&context, node, sizeof context);
    if (!relaxed_plan.empty()) {
        GoalMask goals(task_, *tables_, state);
        for (const auto step : relaxed_plan) {
            if (tables_->schema[step] < 0) continue;
            advance(context, step, goals.mask());
            for (const auto goal : tables_->achieves[step]) goals.mask()[goal] = kNoWay;
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

std::uint64_t Scorer::closing_key(const std::byte* node) const {
    Context context;
    std::memcpy(&context, node, sizeof context);
    const auto& [situation, chain, pending, num_steps] = context;
    std::uint64_t key = static_cast<std::uint64_t>(num_steps > 0);
    const auto add = [&key](std::int64_t value) { key = combine(key, static_cast<std::uint64_t>(value)); };
    add(situation.last);
    if (uses_human_) add(situation.last_human);
    for (std::int32_t i = 0; i < situation.num_open; ++i) add(situation.open[i]);
    for (std::size_t i = 0; i < (uses_returns_ ? kRecentSteps - 1 : 1); ++i) add(situation.robot_steps[i]);
    add(situation.neighbour);
    key = combine(key, bits(pending));
    key = combine(key, bits(chain.odds));
    return combine(key, bits(chain.count[1] - chain.count[0]));
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

// Makes the features of the last step final, now that the next is known, and takes in the next.
void Scorer::advance(Context& context, OperatorId step, Closed closed) const {
    auto& situation = context.situation;
    int neighbour = kHumanStep;
    const double score = is_human(step) ? 0 : step_score(situation, step, closed, neighbour);
    if (context.num_steps > 0) {
        const bool human = is_human(situation.last);
        append(context.chain, human, human ? 0 : context.pending + look_ahead(situation, step, neighbour));
    }
    context.pending = score;
    ++context.num_steps;
    remember(situation, step, neighbour);
}

double Scorer::step_score(const Situation& situation, OperatorId step, Closed closed, int& neighbour) const {
    const auto& tables = *tables_;
    const int me = schema(step);
    double score = weights_.get(Template::kStep, me) + weights_.get(Template::kAfter, me, schema(situation.last));
    score += equality_score(Template::kSameAfter, step, situation.last);
    if (uses_human_) score += equality_score(Template::kSameHuman, step, situation.last_human);
    if (tables.takes_back(step, situation.robot_steps[0]))
        score += weights_.get(Template::kUndoes, me);
    else if (uses_returns_ && std::any_of(situation.robot_steps.begin() + 1, situation.robot_steps.end(),
                                          [&](OperatorId earlier) { return tables.takes_back(step, earlier); }))
        score += weights_.get(Template::kReturns, me);
    if (!tables.in_mental[step]) score += weights_.get(Template::kUnbelieved, me);

    const int request = situation.request();
    auto mental = tables.toward_request(Model::kMental, step, request);
    auto own = tables.toward_request(Model::kOwn, step, request);
    const auto open = std::span(situation.open).first(static_cast<std::size_t>(situation.num_open));
    if (mental != Progress::kDone && std::ranges::any_of(tables.fulfils[step], [&](std::int32_t fulfilled) {
            return std::ranges::find(open, fulfilled) != open.end();
        }))
        mental = own = Progress::kDoneOther;
    const auto goal_mental = tables.toward_nearest_goal(Model::kMental, step, closed);
    const auto goal_own = tables.toward_nearest_goal(Model::kOwn, step, closed);
    const auto mission = tables.toward_mission(step, closed);
    score += weights_.get(Template::kRequestMental, me, mental) + weights_.get(Template::kRequestOwn, me, own) +
             weights_.get(Template::kGoalMental, me, goal_mental) + weights_.get(Template::kGoalOwn, me, goal_own) +
             weights_.get(Template::kMission, me, mission) + weights_.get(Template::kRequestModels, mental, own) +
             weights_.get(Template::kRequestMission, mental, mission) +
             weights_.get(Template::kTrend, mental, situation.neighbour);
    neighbour = static_cast<int>(mental);
    return score;
}

// A feature for every argument of `step` that equals an argument of `other`.
double Scorer::equality_score(Template same, OperatorId step, OperatorId other) const {
    if (other < 0) return 0;
    const auto arity = static_cast<std::size_t>(tables_->max_arity);
    const auto* const mine = tables_->arguments.data() + static_cast<std::size_t>(step) * arity;
    const auto* const theirs = tables_->arguments.data() + static_cast<std::size_t>(other) * arity;
    double score = 0;
    for (std::size_t i = 0; i < arity && mine[i] >= 0; ++i)
        for (std::size_t j = 0; j < arity && theirs[j] >= 0; ++j)
            if (mine[i] == theirs[j]) score += weights_.get(same, schema(step), schema(other), i, j);
    return score;
}

// The features of the last step, a robot's, that see the step after it.
double Scorer::look_ahead(const Situation& situation, OperatorId next, int neighbour) const {
    return weights_.get(Template::kBefore, schema(situation.last), schema(next)) +
           equality_score(Template::kSameBefore, situation.last, next) +
           weights_.get(Template::kOutlook, situation.neighbour, neighbour);
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
