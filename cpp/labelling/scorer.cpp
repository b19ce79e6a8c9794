#include "labelling/scorer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace explicable {

std::size_t Scorer::context_size() const { return sizeof(Context); }

void Scorer::root(const State&, std::byte* context) const {
    static_assert(std::is_trivially_copyable_v<Context>);
    std::memcpy(context, &start_, sizeof start_);
}

void Scorer::extend(const std::byte* parent, OperatorId step, const State& before, const State& after,
                    std::byte* child) const {
    Context context;
    std::memcpy(&context, parent, sizeof context);
    if ((*tables_)[step].schema >= 0) {
        if (choices_) {
            const auto requests = context.situation.requests();
            context.charge += price_of_surprise_ * choices_->surprise(human_weights_, before, requests, step);
        }
        advance(context, context.chain, step, tables_->open_goals(before));
        withdraw_requests(context.situation, after);
    }
    std::memcpy(child, &context, sizeof context);
}

// Takes in a relaxed plan; makes the features of the last step final.
template <class Labels>
void Scorer::walk(Context& context, Labels& labels, const State& state, std::span<const OperatorId> relaxed_plan) const {
    if (!relaxed_plan.empty()) {
        OpenGoals goals = tables_->open_goals(state);
        for (const auto step : relaxed_plan) {
            if (tables_->is_auxiliary(step)) continue;
            advance(context, labels, step, goals);
            for (const auto goal : tables_->achieves[step]) goals.close(static_cast<std::size_t>(goal));
        }
    }
    if (context.num_steps == 0) return;
    append(labels, context.pending + look_ahead(context.situation, -1, kNothing));
}

PathScore Scorer::score(const std::byte* node, const State& state, std::span<const OperatorId> relaxed_plan) const {
    Context context = read(node);
    if (!expected_) {
        walk(context, context.chain, state, relaxed_plan);
        return {context.chain.count[static_cast<std::size_t>(context.chain.odds > 0)], 0, context.num_steps};
    }
    auto tally = tally_of<2>(context.chain);
    walk(context, tally, state, relaxed_plan);
    if (context.num_steps == 0) return {0, 0, 0};
    return {tally.mean(), tally.variance(), context.num_steps};
}

double Scorer::count_after(Context context, OperatorId step, const OpenGoals& goals, const State& state,
                           std::span<const OperatorId> relaxed_plan) const {
    auto tally = tally_of<1>(context.chain);
    if (step >= 0 && !tables_->is_auxiliary(step)) {
        advance(context, tally, step, goals);
        withdraw_requests(context.situation, state);
    }
    walk(context, tally, state, relaxed_plan);
    return tally.mean();
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
           situation.neighbour < kNumNeighbours && context.charge >= 0;
}

void Scorer::start_at(std::span<const std::byte> context) {
    start_ = read(context.data());
    start_.charge = 0;  // what is done is done
}

void Scorer::add_charge(std::byte* bytes, double charge) const {
    Context context = read(bytes);
    context.charge += charge;
    std::memcpy(bytes, &context, sizeof context);
}

void Scorer::charge_for(std::shared_ptr<const HumanChoices> choices, const HumanWeights& weights, double price) {
    choices_ = std::move(choices);
    human_weights_ = weights;
    price_of_surprise_ = price;
}

// Makes the features of the last step final, now that the next is known, and takes in the next.
template <class Labels>
void Scorer::advance(Context& context, Labels& labels, OperatorId step, const OpenGoals& goals) const {
    auto& situation = context.situation;
    const StepScore score = judge(situation, step, goals);
    if (context.num_steps > 0) append(labels, context.pending + score.of_last);
    context.pending = score.of_step + taking_back(situation.robot_steps, step);
    ++context.num_steps;
    remember(situation, step, score.neighbour);
}

Scorer::StepScore Scorer::judge(const Situation& situation, OperatorId step, const OpenGoals& goals) const {
    int neighbour = kHumanStep;
    const double own = is_human(step) ? kExplicable : own_score(situation, step, goals, neighbour);
    const Pair pair = side_by_side(situation, step, neighbour);
    return {pair.of_last, own + pair.of_step, neighbour};
}

double Scorer::own_score(const Situation& situation, OperatorId step, const OpenGoals& goals, int& neighbour) const {
    const auto& tables = *tables_;
    const TeamStep& taken = tables[step];
    const auto me = static_cast<std::size_t>(taken.schema);
    double score = alone_[me * 2 + taken.in_mental];
    if (!own_.empty()) score += own_[static_cast<std::size_t>(step)];
    if (uses_human_) score += same_human_.of(taken, tables[situation.last_human]);
    auto request = tables.toward_request(step, situation.request());
    if (tables.marks(step).fulfils && request.mental() != Progress::kDone && fulfils_open(situation, step))
        request = {Progress::kDoneOther, Progress::kDoneOther};
    const auto goal = tables.toward_goals(step, goals);
    neighbour = static_cast<int>(request.mental());
    return score + request_[me * kCodes * kCodes + request.code] + goals_[me * kCodes * kCodes * kCodes + goal.code] +
           request_mission_[static_cast<std::size_t>(request.mental()) * kCodes + static_cast<std::size_t>(goal.mission())];
}

// Whether it undoes the last step of a robot, or one of those before that.
double Scorer::taking_back(const RobotSteps& recent, OperatorId step) const {
    const auto takes_back = [this, step](OperatorId earlier) { return tables_->takes_back(step, earlier); };
    if (takes_back(recent[0])) return undoes_[schema_of(step)];
    return uses_returns_ && std::any_of(recent.begin() + 1, recent.end(), takes_back) ? returns_[schema_of(step)] : 0;
}

Scorer::Pair Scorer::pair_score(OperatorId last, OperatorId next) const {
    const TeamStep& before = (*tables_)[last];
    const TeamStep& after = (*tables_)[next];
    Pair pair = schemas_[place_of_schemas(after, before)];
    pair += same_.of(after, before);
    return pair;
}

bool Scorer::fulfils_open(const Situation& situation, OperatorId step) const {
    const auto open = situation.requests();
    for (const auto request : tables_->fulfils[step])
        if (std::ranges::find(open, request) != open.end()) return true;
    return false;
}

void Scorer::remember(Situation& situation, OperatorId step, int neighbour) const {
    situation.last = step;
    situation.neighbour = neighbour;
    if (!is_human(step)) {
        for (std::size_t i = kRecentSteps - 1; i > 0; --i) situation.robot_steps[i] = situation.robot_steps[i - 1];
        situation.robot_steps[0] = step;
    }
    remember_requests(situation, step);
}

// A request whose fact is gone has been withdrawn.
void Scorer::withdraw_requests(Situation& situation, const State& state) const {
    std::int32_t kept = 0;
    for (std::int32_t i = 0; i < situation.num_open; ++i)
        if (tables_->stands(task_, state, situation.open[i])) situation.open[kept++] = situation.open[i];
    std::fill(situation.open.begin() + kept, situation.open.end(), 0);
    situation.num_open = kept;
}

void Scorer::remember_requests(Situation& situation, OperatorId step) const {
    auto& open = situation.open;
    auto& count = situation.num_open;
    // None stands there twice.
    const auto close = [&](std::int32_t request) {
        std::int32_t place = 0;
        while (place < count && open[static_cast<std::size_t>(place)] != request) ++place;
        if (place == count) return;
        for (--count; place < count; ++place) open[static_cast<std::size_t>(place)] = open[static_cast<std::size_t>(place) + 1];
        open[static_cast<std::size_t>(count)] = 0;
    };
    if (!is_human(step)) {
        if (count > 0 && tables_->marks(step).fulfils)
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

}  // namespace explicable
