// Better and better J, by searches near the best plan; and the proof that none is better, where the task is small enough.
#include <algorithm>
#include <limits>
#include <memory>

#include "search/beam.hpp"
#include "search/best_first.hpp"
#include "search/goal_order.hpp"
#include "search/hill_climbing.hpp"
#include "search/improve.hpp"
#include "search/objective_search.hpp"
#include "search/outlook.hpp"
#include "search/solve.hpp"

namespace explicable {

namespace {

constexpr std::int32_t small_task = 400;             // facts and operators
constexpr double worthwhile = 1e-3;                  // share of J for which a neighbourhood is looked at again
constexpr std::int32_t small_neighbourhood = 2'000;  // states
constexpr std::int32_t neighbourhoods[] = {small_neighbourhood, 8'000, 32'000, 128'000};
constexpr std::size_t beam_widths[] = {30, 60, 120, 400};
constexpr std::int64_t slice_far = 50'000;  // evaluations

class Improvement {
public:
    Improvement(const Question& question, const SearchOptions& options, Monitor& monitor, Incumbent& best)
        : question_(question), options_(options), monitor_(monitor), best_(best) {
        // Steps that cost nothing could dilute a ratio without end, so there lengths are ignored and nothing is proved.
        const auto& cost = question.task.cost;
        can_dilute_ = best.ratio && std::find(cost.begin(), cost.end(), 0) != cost.end();
        closing_ = !best.ratio ? Closing::objective : can_dilute_ ? Closing::context : Closing::context_and_length;
    }

    void run(SearchAnswer& answer) {
        try_quick_searches();
        // In a small task all states can be listed soon; in a large one hardly ever.
        const bool is_small = question_.task.num_facts() + question_.task.num_operators() <= small_task;
        if (!settle(best_, is_small ? small_neighbourhood : neighbourhoods[1]) || (!is_small && !look_around())) return;
        Outlook outlook = make_outlook();
        if (!outlook.prepare(monitor_, best_.objective - rounding, offer(best_))) return;
        answer.lower_bound = std::min(outlook.from_start(), best_.objective);
        if (!outlook.is_complete() && !((!is_small || outlook.is_exact() || look_around()) && guess(outlook))) return;
        ObjectiveSearch proof(question_, best_, closing_, outlook, 1.0);
        const std::int64_t slice = outlook.is_exact() ? std::numeric_limits<std::int64_t>::max() : slice_far;
        for (std::uint64_t attempt = 1;; ++attempt) {
            const Status status = proof.run(monitor_, slice, options_.gap, best_);
            if (!can_dilute_) {
                answer.lower_bound = std::max(answer.lower_bound, proof.lower_bound(best_));
                answer.is_optimal = answer.lower_bound >= best_.objective - rounding;
            }
            if (status != Status::paused || !start_anew(attempt)) return;
        }
    }

private:
    const Question& question_;
    const SearchOptions& options_;
    Monitor& monitor_;
    Incumbent& best_;
    bool can_dilute_;
    Closing closing_;

    Outlook make_outlook() const { return {question_, best_.ratio ? nullptr : best_.scorer, best_.alpha, best_.max_cost}; }
    Outlook::Offer offer(Incumbent& best) const {
        return [this, &best](std::vector<OperatorId> plan) {
            best.offer(std::move(plan), question_);
            return best.objective - rounding;
        };
    }

    // For a first good plan; the larger the task, the fewer evaluations.
    void try_quick_searches() {
        const std::int64_t size = question_.task.num_facts() + question_.task.num_operators();
        const std::int64_t few = std::clamp<std::int64_t>(2'000'000 / (size + 1), 50, 2'000);
        const LabelledOptions labelled{options_.labelled.scorer, Closing::state};
        BestFirstOptions eager;
        eager.labelled = labelled;
        eager.seed = options_.seed;
        HillClimbing climbing(question_, labelled, options_.seed);
        BestFirstSearch best_first(question_, std::move(eager));
        for (Engine* engine : {static_cast<Engine*>(&climbing), static_cast<Engine*>(&best_first)}) {
            if (engine->run(monitor_, few) == Status::solved) best_.offer(engine->plan(), question_);
        }
    }

    // Goes to the best plan that a beam finds among states near the present one, again and again, with more and more states.
    // That is plan neighbourhood graph search (Nakhost & Mueller 2010) with J, which hangs on the whole path, in the place of the
    // cost; in the neighbourhood costs-to-go are exact. False if the monitor stopped.
    bool settle(Incumbent& best, std::int32_t largest) {
        for (std::size_t size = 0; size < std::size(neighbourhoods) && neighbourhoods[size] <= largest;) {
            const double before = best.objective;
            Outlook near(question_, nullptr, best.alpha, best.max_cost);
            if (!near.prepare_near(monitor_, *best.plan, neighbourhoods[size], best.objective - rounding, offer(best)))
                return false;
            if (!search_beam(question_, closing_, near, beam_widths[size], monitor_, best)) return false;
            if (best.objective >= (1.0 - worthwhile) * before) ++size;  // also where both are 0
        }
        return monitor_.stop() == Stop::none;
    }

    // Other orders of the goals, and then near the best plan.
    bool look_around() {
        GoalOrder order(question_, {options_.labelled.scorer, Closing::state}, options_.seed);
        return order.improve(monitor_, best_, false) && settle(best_, neighbourhoods[std::size(neighbourhoods) - 1]);
    }

    // Where the sweeps were too large to finish: by searches that trust the bounds more.
    bool guess(const Outlook& outlook) {
        for (const double weight : {3.0, 1.5}) {
            ObjectiveSearch search(question_, best_, closing_, outlook, weight);
            if (search.run(monitor_, slice_far, options_.gap, best_) == Status::stopped) return false;
        }
        return true;
    }

    // From another plan than the best: from an order of the goals that is drawn at random.
    bool start_anew(std::uint64_t attempt) {
        Incumbent other{best_.scorer, best_.alpha, best_.ratio, best_.max_cost};
        other.offer(*best_.plan, question_);
        GoalOrder order(question_, {options_.labelled.scorer, Closing::state}, options_.seed + attempt);
        const bool goes_on = order.improve(monitor_, other, true) && settle(other, neighbourhoods[1]);
        if (other.objective >= best_.objective - rounding) return goes_on;
        best_.offer(*other.plan, question_);
        return goes_on && settle(best_, neighbourhoods[2]);
    }
};

}  // namespace

void improve_objective(const Question& question, const SearchOptions& options, Monitor& monitor, Incumbent& best,
                       SearchAnswer& answer) {
    Improvement(question, options, monitor, best).run(answer);
}

}  // namespace explicable
