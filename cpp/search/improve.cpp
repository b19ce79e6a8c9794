#include "search/improve.hpp"

#include <algorithm>
#include <stdexcept>

#include "search/best_first.hpp"
#include "search/hill_climbing.hpp"
#include "search/outlook.hpp"
#include "search/plan_check.hpp"
#include "search/solve.hpp"
#include "task/successor.hpp"

namespace explicable {

namespace {

constexpr double weights[] = {5.0, 3.0, 2.0, 1.0};  // of h, from one restart to the next
constexpr std::int64_t first_slice = 1'000;

// What the scorer says of a whole plan.
PathScore score_plan(const PathScorer& scorer, const Question& question, const std::vector<OperatorId>& plan) {
    State state = question.initial;
    std::vector<std::byte> context(scorer.context_size()), next(scorer.context_size());
    scorer.root(state, context.data());
    const StatePacker packer(question.task);
    std::vector<Word> from(packer.num_words()), to(packer.num_words());
    packer.pack(state, from.data());
    for (const OperatorId step : plan) {
        apply(question.task, packer, step, from.data(), to.data());
        State after = packer.unpack(to.data());
        scorer.extend(context.data(), step, state, after, next.data());
        std::swap(context, next);
        std::swap(from, to);
        state = std::move(after);
    }
    return scorer.score(context.data(), state, {});
}

BestFirstOptions weighted(double weight, double bound, std::uint64_t seed) {
    BestFirstOptions options;
    options.weight_g = 1.0;
    options.weight_h = weight;
    options.supporter_cost = SupporterCost::plus_one;
    options.reopen = true;
    options.bound = bound;
    options.seed = seed;
    return options;
}

// Restarting weighted A* (Richter, Thayer & Ruml 2010) takes turns with A*, which proves the bound.
void improve_cost(const Question& question, const SearchOptions& options, Monitor& monitor, Incumbent& best,
                  SearchAnswer& answer) {
    BestFirstOptions exact;
    exact.admissible = make_admissible(question, "lmcut");
    exact.weight_g = 1.0;
    exact.reopen = true;
    exact.bound = best.objective;
    BestFirstSearch proof(question, std::move(exact));
    std::size_t restart = 0;
    auto improver = std::make_unique<BestFirstSearch>(question, weighted(weights[0], best.objective, options.seed));
    for (std::int64_t slice = first_slice;; slice *= 2) {
        for (BestFirstSearch* engine : {improver.get(), &proof}) {
            engine->set_bound(best.objective);
            const Status status = engine->run(monitor, slice);
            answer.lower_bound = std::max(answer.lower_bound, std::min(proof.lower_bound(), best.objective));
            if (status == Status::stopped) return;
            if (status == Status::solved) best.offer(engine->plan(), question);
            if (status == Status::exhausted || (status == Status::solved && engine == &proof)) {
                answer.is_optimal = true;
                return;
            }
            if (status == Status::solved && restart + 1 < std::size(weights)) {
                improver = std::make_unique<BestFirstSearch>(question,
                                                             weighted(weights[++restart], best.objective, options.seed));
                slice = first_slice;
            }
        }
    }
}

constexpr double rounding = 1e-9;  // no plan counts as better that is better by less

// A* for J: a node's bound is its cost, alpha times the inexplicable steps that its path will have at the least, and the least
// that lies ahead (outlook.hpp). For a ratio, whose parts don't add up, the bound is of the cost alone.
class ObjectiveSearch {
public:
    ObjectiveSearch(const Question& question, const Incumbent& best, Closing closing, const Outlook& outlook, double weight)
        : question_(question),
          scorer_(*best.scorer),
          price_(best.ratio ? 0.0 : best.alpha),
          weight_(weight),
          outlook_(outlook),
          nodes_(question.task, best.scorer, closing, best.alpha) {}

    // Exhausted: the best plan is optimal, to within `gap` of its objective. Paused: the slice is used up.
    Status run(Monitor& monitor, std::int64_t slice, double gap, Incumbent& best) {
        const std::int64_t end = end_of_slice(monitor, slice);
        if (nodes_.size() == 0) file(nodes_.add_root(question_.initial), monitor, best);
        while (!open_.empty()) {
            if (!monitor.may_go_on([this] { return memory_bytes(); })) return Status::stopped;
            if (monitor.evaluations >= end) return Status::paused;
            if (weight_ == 1.0 && lower_bound(best) >= (1.0 - gap) * best.objective) return Status::exhausted;
            const Open entry = open_.pop();
            if (nodes_.is_dominated(entry.node) || entry.bound >= best.objective - rounding) continue;
            ++monitor.expansions;
            nodes_.state(entry.node, state_);
            question_.successors.applicable(state_, applicable_);
            for (const OperatorId step : applicable_) {
                const auto arrival = nodes_.add(entry.node, step);
                if (arrival.is_new) file(arrival.node, monitor, best);
            }
        }
        return Status::exhausted;
    }
    double lower_bound(const Incumbent& best) const {
        return open_.empty() ? best.objective : std::min(open_.lowest().first, best.objective);
    }
    std::size_t memory_bytes() const { return outlook_.memory_bytes() + nodes_.memory_bytes() + open_.memory_bytes(); }

private:
    struct Open {
        NodeId node;
        double bound;
    };

    const Question& question_;
    const PathScorer& scorer_;
    double price_, weight_;
    const Outlook& outlook_;
    NodeStore nodes_;
    OpenList<Open> open_;
    State state_, child_;
    std::vector<OperatorId> applicable_;

    void file(NodeId node, Monitor& monitor, Incumbent& best) {
        ++monitor.evaluations;
        const double ahead = outlook_(nodes_.words(node), nodes_.context(node));
        if (ahead == dead_end) return;
        const auto cost = static_cast<double>(nodes_.cost(node));
        const double penalty = best.penalty({nodes_.path_count(node), 0.0, nodes_.path_steps(node)});
        if (cost + penalty < best.objective) {
            nodes_.state(node, child_);
            if (question_.is_goal(child_)) best.offer(nodes_.path(node), question_);
        }
        const double so_far = cost + price_ * scorer_.least_count(nodes_.context(node));
        if (so_far + ahead >= best.objective - rounding) return;
        open_.push({so_far + weight_ * ahead, best.ratio ? penalty : ahead}, {node, so_far + ahead});
    }
};

// Quick searches for a first good plan, each for so many evaluations.
void try_quick_searches(const Question& question, const SearchOptions& options, Monitor& monitor, Incumbent& best) {
    constexpr std::int64_t few = 2'000;
    const LabelledOptions labelled{options.labelled.scorer, Closing::state};
    BestFirstOptions eager;
    eager.labelled = labelled;
    eager.seed = options.seed;
    HillClimbing climbing(question, labelled, options.seed);
    BestFirstSearch best_first(question, std::move(eager));
    for (Engine* engine : {static_cast<Engine*>(&climbing), static_cast<Engine*>(&best_first)}) {
        if (engine->run(monitor, few) == Status::solved) best.offer(engine->plan(), question);
    }
}

// Sweeps over what may lie ahead, then A*. Where the sweeps were too large to finish, searches that trust them more go first.
void improve_objective(const Question& question, const SearchOptions& options, Monitor& monitor, Incumbent& best,
                       SearchAnswer& answer) {
    constexpr std::int64_t slice = 50'000;
    try_quick_searches(question, options, monitor, best);
    // Steps that cost nothing could dilute a ratio without end, so there lengths are ignored and nothing is proved.
    const auto& cost = question.task.cost;
    const bool can_dilute = best.ratio && std::find(cost.begin(), cost.end(), 0) != cost.end();
    const Closing closing = !best.ratio  ? Closing::objective
                            : can_dilute ? Closing::context
                                         : Closing::context_and_length;
    Outlook outlook(question, best.ratio ? nullptr : best.scorer, best.alpha);
    const auto offer = [&](std::vector<OperatorId> plan) {
        best.offer(std::move(plan), question);
        return best.objective - rounding;
    };
    if (!outlook.prepare(monitor, best.objective - rounding, offer)) return;
    answer.lower_bound = std::min(outlook.from_start(), best.objective);
    if (!outlook.is_complete()) {
        for (const double weight : {3.0, 1.5}) {
            ObjectiveSearch(question, best, closing, outlook, weight).run(monitor, slice, options.gap, best);
        }
    }
    ObjectiveSearch search(question, best, closing, outlook, 1.0);
    search.run(monitor, std::numeric_limits<std::int64_t>::max(), options.gap, best);
    if (can_dilute) return;
    answer.lower_bound = std::max(answer.lower_bound, search.lower_bound(best));
    answer.is_optimal = answer.lower_bound >= best.objective - rounding;
}

}  // namespace

double Incumbent::penalty(const PathScore& score) const {
    const double dist = !ratio ? score.num_inexplicable
                        : score.num_steps > 0 ? score.num_inexplicable / score.num_steps : 0.0;
    return alpha * dist;
}

bool Incumbent::offer(std::vector<OperatorId> candidate, const Question& question) {
    const auto executed = execute_plan(question.task, question.initial, question.goal, candidate);
    if (!executed) throw std::logic_error("the search made a plan that its task refuses");
    double value = static_cast<double>(*executed);
    if (scorer) value += penalty(score_plan(*scorer, question, candidate));
    if (value >= objective) return false;
    plan = std::move(candidate);
    cost = *executed;
    objective = value;
    return true;
}

void improve(const Question& question, const SearchOptions& options, Monitor& monitor, Incumbent& best,
             SearchAnswer& answer) {
    if (!options.labelled.scorer) return improve_cost(question, options, monitor, best, answer);
    improve_objective(question, options, monitor, best, answer);
}

}  // namespace explicable
