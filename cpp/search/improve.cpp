#include "search/improve.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "search/best_first.hpp"
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

// Best-first by g + alpha * dist of the path + an admissible bound on the cost to go. A node is dropped once its cost
// alone can't beat the best plan: what lies ahead might make earlier steps look better, so the count is no bound.
class ObjectiveSearch {
public:
    ObjectiveSearch(const Question& question, const SearchOptions& options, Closing closing, Incumbent& best)
        : question_(question),
          best_(best),
          nodes_(question.task, options.labelled.scorer, closing),
          heuristic_(make_admissible(question, "lmcut")) {}

    // True if the best plan is optimal now.
    bool run(Monitor& monitor) {
        file(nodes_.add_root(question_.initial), monitor);
        while (!open_.empty()) {
            if (!monitor.may_go_on([this] { return memory_bytes(); })) return false;
            const Open entry = open_.pop();
            forget(entry.bound);
            if (nodes_.is_dominated(entry.node) || entry.bound >= best_.objective) continue;
            ++monitor.expansions;
            nodes_.state(entry.node, state_);
            question_.successors.applicable(state_, applicable_);
            for (const OperatorId step : applicable_) {
                const auto arrival = nodes_.add(entry.node, step);
                if (arrival.is_new) file(arrival.node, monitor);
            }
        }
        return true;
    }
    double lower_bound() const { return bounds_.empty() ? best_.objective : std::min(bounds_.begin()->first, best_.objective); }
    std::size_t memory_bytes() const {
        return nodes_.memory_bytes() + open_.memory_bytes() + bounds_.size() * 64;
    }

private:
    struct Open {
        NodeId node;
        double bound;
    };

    const Question& question_;
    Incumbent& best_;
    NodeStore nodes_;
    std::unique_ptr<AdmissibleHeuristic> heuristic_;
    OpenList<Open> open_;
    std::map<double, std::int64_t> bounds_;  // of the open nodes, with how many there are
    State state_, child_;
    std::vector<OperatorId> applicable_;

    void file(NodeId node, Monitor& monitor) {
        nodes_.state(node, child_);
        ++monitor.evaluations;
        const double h = heuristic_->evaluate(child_);
        if (h == dead_end) return;
        const PathScore score{nodes_.path_count(node), 0.0, nodes_.path_steps(node)};
        const double cost = static_cast<double>(nodes_.cost(node)), f = cost + best_.penalty(score);
        if (f < best_.objective && question_.is_goal(child_)) best_.offer(nodes_.path(node), question_);
        if (cost + h >= best_.objective) return;
        open_.push({f + h, h}, {node, cost + h});
        ++bounds_[cost + h];
    }
    void forget(double bound) {
        const auto found = bounds_.find(bound);
        if (--found->second == 0) bounds_.erase(found);
    }
};

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
    // Steps that cost nothing could dilute a ratio without end, so there lengths are ignored and nothing is proved.
    const auto& cost = question.task.cost;
    const bool can_dilute = best.ratio && std::find(cost.begin(), cost.end(), 0) != cost.end();
    const Closing closing = best.ratio && !can_dilute ? Closing::context_and_length : Closing::context;
    ObjectiveSearch search(question, options, closing, best);
    answer.is_optimal = search.run(monitor) && !can_dilute;
    if (can_dilute) return;
    answer.lower_bound = std::max(answer.lower_bound, search.lower_bound());
}

}  // namespace explicable
