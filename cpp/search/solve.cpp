#include "search/solve.hpp"

#include <algorithm>
#include <new>
#include <stdexcept>

#include "search/best_first.hpp"
#include "search/heuristics.hpp"
#include "search/hill_climbing.hpp"
#include "search/improve.hpp"
#include "search/lazy.hpp"
#include "search/plan_improvement.hpp"
#include "search/portfolio.hpp"
#include "search/width.hpp"

namespace explicable {

namespace {

constexpr std::int64_t elimination_budget = 4'000'000;  // steps executed
constexpr std::size_t neighbourhood_budget = 10'000;    // transitions
constexpr std::int64_t no_slice = std::numeric_limits<std::int64_t>::max();

class Solver {
public:
    Solver(const Question& question, const SearchOptions& options) : question_(question), options_(options) {}

    std::unique_ptr<Engine> engine() const {
        const std::string& name = options_.algorithm;
        if (name == "default" || name == "anytime") return standard();
        if (name == "lazy") return lazy(options_.lookahead ? Ahead::bridged : Ahead::no);
        if (name == "eager") return eager();
        if (name == "ff") return ff();
        if (name == "bfws") return std::make_unique<WidthSearch>(question_, options_.seed);
        if (name == "astar" || name == "wastar") return astar();
        throw std::invalid_argument("unknown search algorithm: " + name);
    }

private:
    const Question& question_;
    const SearchOptions& options_;

    std::unique_ptr<Engine> lazy(Ahead ahead) const {
        return std::make_unique<LazySearch>(question_, options_.preferred, options_.labelled, options_.seed, ahead);
    }
    std::unique_ptr<Engine> eager() const {
        BestFirstOptions best_first;
        best_first.preferred = options_.preferred;
        best_first.labelled = options_.labelled;
        best_first.seed = options_.seed;
        return std::make_unique<BestFirstSearch>(question_, std::move(best_first));
    }
    // Hill-climbing as published, but with a budget: where it works at all it is quick.
    std::unique_ptr<Engine> ff() const {
        auto climb = [this] { return std::make_unique<HillClimbing>(question_, options_.labelled, options_.seed); };
        auto best_first = [this] {
            BestFirstOptions plain;
            plain.labelled = options_.labelled;
            plain.seed = options_.seed;
            return std::make_unique<BestFirstSearch>(question_, std::move(plain));
        };
        return std::make_unique<Portfolio>(std::vector<Portfolio::Member>{{climb, 100'000, 0}, {best_first, no_slice, 1}});
    }
    // Relaxed plans first, carried out at once, since they mostly lead straight to the goal; where they do not, plain lazy
    // search or novelty often does. A relaxed plan costs more the larger the task is, hardly so a look at novelty.
    std::unique_ptr<Engine> standard() const {
        using Members = std::vector<Portfolio::Member>;
        auto ahead = [this] { return lazy(Ahead::bridged); };
        auto plain = [this] { return lazy(Ahead::no); };
        const std::int64_t size = question_.task.num_facts() + question_.task.num_operators();
        const auto slice = [size](std::int64_t work, std::int64_t least, std::int64_t most) {
            return std::clamp(work / (size + 1), least, most);
        };
        // A look-ahead does not ask what people make of its steps, so it comes last where the order of f is affordable.
        if (options_.labelled.scorer) {
            return std::make_unique<Portfolio>(Members{{plain, slice(5'000'000, 50, 1'000), 0}, {ahead, no_slice, 1}});
        }
        auto careful = [this] { return lazy(Ahead::plain); };
        auto width = [this] { return std::make_unique<WidthSearch>(question_, options_.seed); };
        return std::make_unique<Portfolio>(Members{
            {ahead, slice(10'000'000, 100, 1'000), 2}, {careful, slice(5'000'000, 50, 500), 2}, {plain, slice(40'000'000, 500, 4'000), 2}, {width, 30'000, 3}});
    }
    std::unique_ptr<Engine> astar() const {
        BestFirstOptions best_first;
        best_first.weight_g = 1.0;
        best_first.weight_h = options_.algorithm == "astar" ? 1.0 : options_.weight;
        best_first.reopen = true;
        best_first.seed = options_.seed;
        const std::string fallback = options_.algorithm == "astar" ? "lmcut" : "ff";
        const std::string& name = options_.heuristic.empty() ? fallback : options_.heuristic;
        if (name == "ff" && options_.algorithm == "wastar") {
            best_first.supporter_cost = SupporterCost::plus_one;
        } else {
            best_first.admissible = make_admissible(question_, name);
            if (!best_first.admissible) throw std::invalid_argument("unknown heuristic: " + name);
        }
        return std::make_unique<BestFirstSearch>(question_, std::move(best_first));
    }
};

// Searches that stop at their first plan.
void find_plan(const Question& question, Engine& engine, Monitor& monitor, Incumbent& best, SearchAnswer& answer) {
    const Status status = engine.run(monitor, no_slice);
    answer.memory_bytes = engine.memory_bytes();
    if (status == Status::solved) best.offer(engine.plan(), question);
    answer.is_exhausted = status == Status::exhausted && engine.is_complete();
}

// Takes out of a plan found in haste what was too much, where that makes it better.
void polish(const Question& question, Incumbent& best) {
    auto plan = eliminate_actions(question, *best.plan, elimination_budget);
    best.offer(search_neighbourhood(question, plan, neighbourhood_budget), question);
    if (best.scorer) best.offer(std::move(plan), question);
}

}  // namespace

SearchAnswer solve(const Question& question, const SearchOptions& options, Monitor& monitor) {
    SearchAnswer answer;
    Incumbent best{options.labelled.scorer, options.alpha, options.ratio, options.max_cost};
    if (options.algorithm == "anytime") best.on_better = options.on_better;
    try {
        SearchOptions first = options;
        // A first plan is wanted soon; the search that improves it has its own way of closing nodes.
        if (options.algorithm == "anytime") first.labelled.closing = Closing::state;
        const Solver solver(question, first);
        for (const auto& plan : options.known_plans) best.offer(plan, question);
        if (!best.plan) find_plan(question, *solver.engine(), monitor, best, answer);
        // The first plan of a labelled search was chosen for its steps, and only J can say whether fewer are better.
        const bool by_cost = options.algorithm == "default" && !options.labelled.scorer;
        if (best.plan && (by_cost || options.algorithm == "anytime")) polish(question, best);
        answer.is_optimal = best.plan && options.algorithm == "astar";
        if (options.algorithm == "anytime" && best.plan && monitor.stop() == Stop::none) {
            improve(question, options, monitor, best, answer);
        }
    } catch (const std::bad_alloc&) {
        monitor.out_of_memory();
    }
    answer.stop = monitor.stop();
    answer.outcome = answer.stop == Stop::interrupt ? Outcome::interrupted
                     : best.plan                    ? Outcome::solved
                     : answer.is_exhausted          ? Outcome::unsolvable
                                                    : Outcome::limit;
    answer.cost = best.cost;
    answer.objective = best.objective;
    if (answer.is_optimal) answer.lower_bound = best.objective;
    answer.plan = std::move(best.plan);
    answer.evaluations = monitor.evaluations;
    answer.expansions = monitor.expansions;
    answer.search_s = monitor.elapsed_s();
    return answer;
}

}  // namespace explicable
