#include "labelling/human_choices.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "labelling/distances.hpp"
#include "task/task_index.hpp"

namespace explicable {
namespace {

double log1p_exp(double x) { return x > 0 ? x + std::log1p(std::exp(-x)) : std::log1p(std::exp(x)); }

double score_of(const HumanOption& option, const HumanWeights& weights) {
    const auto weight = [&weights](HumanFeature feature) { return weights[static_cast<std::size_t>(feature)]; };
    double score = option.repeats ? weight(HumanFeature::kRepeats) : 0;
    if (option.request < 0) return score + weight(HumanFeature::kAsksForNothing);
    if (option.distance == kNoWay) return score + weight(HumanFeature::kSeemsImpossible);
    if (option.is_nearest()) score += weight(HumanFeature::kNearest);
    return score + option.rank * weight(HumanFeature::kRank);
}

}  // namespace

HumanChoices::HumanChoices(const Task& composite, const Task& mental, const MentalNames& names,
                           std::shared_ptr<const TeamTables> tables)
    : task_(composite),
      tables_(std::move(tables)),
      action_of_(static_cast<std::size_t>(composite.num_operators()), -1),
      ways_(static_cast<std::size_t>(tables_->num_requests())) {
    std::map<std::vector<std::int32_t>, std::int32_t> numbers;
    for (OperatorId op = 0; op < composite.num_operators(); ++op) {
        const TeamStep& step = (*tables_)[op];
        if (!tables_->marks(op).is_human || step.schema < 0) continue;
        std::vector<std::int32_t> action{step.schema};
        const auto objects = composite.operator_arguments[op];
        action.insert(action.end(), objects.begin(), objects.end());
        action_of_[op] = numbers.try_emplace(std::move(action), static_cast<std::int32_t>(actions_.size())).first->second;
        if (static_cast<std::size_t>(action_of_[op]) == actions_.size()) actions_.emplace_back();
        actions_[action_of_[op]].push_back(op);
    }

    // The mental task's facts and operators in the composite task's numbers, and back.
    const auto mental_fact = find_mental_facts(composite, mental, names);
    std::vector<FactId> own_fact(static_cast<std::size_t>(mental.num_facts()), -1);
    for (FactId fact = 0; fact < composite.num_facts(); ++fact)
        if (mental_fact[fact] >= 0) own_fact[mental_fact[fact]] = fact;
    TaskIndex in_mental_task(mental);
    const TransitionGraph graph(mental);
    std::map<FactId, std::int32_t> need_of;  // fact of the mental task

    const auto need = [&](FactId fact) {
        const auto [place, is_new] = need_of.try_emplace(fact, static_cast<std::int32_t>(needs_.size()));
        if (!is_new) return place->second;
        const auto distance = graph.to_goal(fact);
        const VariableId variable = composite.fact_variable[own_fact[fact]];
        const bool can_be_added = std::ranges::any_of(mental.adds.values, [fact](FactId added) { return added == fact; });
        Need found{variable, {can_be_added ? Distance{1} : kNoWay}};
        for (const FactId value : composite.variable_facts[variable])
            found.by_value.push_back(mental_fact[value] < 0 ? found.by_value[0] : distance[mental_fact[value]]);
        needs_.push_back(std::move(found));
        return place->second;
    };
    std::vector<std::int32_t> arguments;
    for (OperatorId op = 0; op < composite.num_operators(); ++op) {
        const TeamStep& step = (*tables_)[op];
        if (!tables_->marks(op).fulfils || step.schema < 0 || names.schema[step.schema] < 0 ||
            !translate_objects(composite.operator_arguments[op], names.object, arguments))
            continue;
        for (const OperatorId theirs : in_mental_task.find_operators(names.schema[step.schema], arguments)) {
            for (const auto request : tables_->fulfils[op]) {
                const auto asked = tables_->request_facts[request];
                Way way;
                bool is_open = true;
                for (const FactId fact : mental.preconditions[theirs]) {
                    if (own_fact[fact] >= 0 && std::ranges::find(asked, own_fact[fact]) != asked.end()) continue;
                    if (own_fact[fact] >= 0)
                        way.push_back(need(fact));
                    else  // never changes
                        is_open &= std::ranges::binary_search(mental.initial, fact);
                }
                if (is_open) ways_[request].push_back(std::move(way));
            }
        }
    }
}

Distance HumanChoices::distance(const State& state, std::int32_t request) const {
    int least = kNoWay;
    for (const Way& way : ways_[request]) {
        int sum = 0;
        for (const auto need : way) {
            const int steps = needs_[need].by_value[state.values[needs_[need].variable]];
            sum = steps == kNoWay ? kNoWay : std::min<int>(sum + steps, kNoWay);
            if (sum == kNoWay) break;
        }
        least = std::min(least, sum);
    }
    return static_cast<Distance>(least);
}

bool HumanChoices::is_possible(const State& state, const std::vector<OperatorId>& action) const {
    return std::ranges::any_of(action, [&](OperatorId step) {
        return std::ranges::all_of(task_.preconditions[step], [&](FactId fact) { return state.holds(task_, fact); });
    });
}

void HumanChoices::list(const State& state, std::span<const std::int32_t> open, std::vector<HumanOption>& options) const {
    options.clear();
    for (const auto& action : actions_) {
        if (!is_possible(state, action)) continue;
        const auto request = tables_->asks_for[action.front()];
        options.push_back({action.front(), request, request < 0 ? kNoWay : distance(state, request), 0,
                           request >= 0 && std::ranges::find(open, request) != open.end()});
    }
    for (HumanOption& option : options) {
        if (option.distance == kNoWay) continue;
        // The number of different lesser distances.
        for (std::size_t i = 0; i < options.size(); ++i) {
            const Distance other = options[i].distance;
            if (other >= option.distance) continue;
            const auto before = std::span(options).first(i);
            option.rank += std::ranges::none_of(before, [other](const HumanOption& o) { return o.distance == other; });
        }
    }
}

double HumanChoices::surprise(const HumanWeights& weights, const State& state, std::span<const std::int32_t> open,
                              OperatorId step) const {
    const auto waits = weights[static_cast<std::size_t>(open.empty() ? HumanFeature::kWaitsNothingOpen
                                                                      : HumanFeature::kWaitsRequestOpen)];
    const std::int32_t action = action_of_[step];
    if (action < 0) {
        const bool has_choice = std::ranges::any_of(actions_, [&](const auto& other) { return is_possible(state, other); });
        return has_choice ? log1p_exp(-waits) : 0;
    }
    std::vector<HumanOption> options;
    list(state, open, options);
    double chosen = 0, greatest = -std::numeric_limits<double>::infinity(), sum = 0;
    for (const HumanOption& option : options) {
        const double score = score_of(option, weights);
        if (action_of_[option.step] == action) chosen = score;
        greatest = std::max(greatest, score);
    }
    for (const HumanOption& option : options) sum += std::exp(score_of(option, weights) - greatest);
    return log1p_exp(waits) + greatest + std::log(sum) - chosen;
}

}  // namespace explicable
