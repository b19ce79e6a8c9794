#include "search/improve.hpp"

#include <algorithm>
#include <stdexcept>

#include "search/best_first.hpp"
#include "search/plan_check.hpp"
#include "search/solve.hpp"
#include "task/successor.hpp"

namespace explicable {

namespace {

constexpr double weights[] = {5.0, 3.0, 2.0, 1.0};  // of h, from one restart to the next
constexpr std::int64_t first_slice = 1'000;

// What the scorer says of a whole plan, and what it charges.
std::pair<PathScore, double> score_plan(const PathScorer& scorer, const Question& question, const std::vector<OperatorId>& plan) {
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
    return {scorer.score(context.data(), state, {}), scorer.charge(context.data())};
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

}  // namespace

double Incumbent::penalty(const PathScore& score) const {
    const double dist = !ratio ? score.num_inexplicable
                        : score.num_steps > 0 ? score.num_inexplicable / score.num_steps : 0.0;
    return alpha * dist;
}

bool Incumbent::offer(std::vector<OperatorId> candidate, const Question& question) {
    const auto executed = execute_plan(question.task, question.initial, question.goal, candidate);
    if (!executed) throw std::logic_error("the search made a plan that its task refuses");
    if (*executed > max_cost) return false;
    double value = static_cast<double>(*executed);
    if (scorer) {
        const auto [score, charge] = score_plan(*scorer, question, candidate);
        value += penalty(score) + charge;
    }
    if (value >= objective) return false;
    plan = std::move(candidate);
    cost = *executed;
    objective = value;
    if (on_better) on_better(value);
    return true;
}

void improve(const Question& question, const SearchOptions& options, Monitor& monitor, Incumbent& best,
             SearchAnswer& answer) {
    if (!options.labelled.scorer) return improve_cost(question, options, monitor, best, answer);
    improve_objective(question, options, monitor, best, answer);
}

}  // namespace explicable
