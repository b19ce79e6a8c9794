#include "grounding/lifted.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <stdexcept>

namespace explicable::grounding {
namespace {

constexpr int max_depth = 500;
constexpr std::int64_t max_memberships = std::int64_t{1} << 28;  // one byte each

[[noreturn]] void refuse(const char* what) { throw std::invalid_argument(what); }

class Reader {
public:
    Reader(std::span<const std::int32_t> stream, LiftedTask& task) : stream_(stream), task_(task) {}

    void read() {
        task_.num_objects = count();
        task_.domains.resize(length());
        if (std::int64_t{task_.num_objects} * std::ssize(task_.domains) > max_memberships)
            refuse("encoded task: too many objects and types");
        for (auto& domain : task_.domains) {
            domain.resize(length());
            std::vector<std::uint8_t> member(task_.num_objects);
            for (auto& object : domain) member[object = below(task_.num_objects)] = 1;
            if (std::adjacent_find(domain.begin(), domain.end(), std::greater_equal<>()) != domain.end())
                refuse("encoded task: objects of a type out of order");
            task_.in_domain.push_back(std::move(member));
        }
        task_.arity.resize(length());
        for (auto& arity : task_.arity) arity = count();
        task_.fluent.resize(task_.arity.size());
        task_.functions.resize(length());
        for (auto& function : task_.functions) function.arity = count();
        task_.schemas.resize(length());
        for (auto& schema : task_.schemas) read_schema(schema);
        scope_ = 0;
        task_.goal = read_formula(false, 0);
        if (position_ != stream_.size()) refuse("encoded task: numbers left over");
    }

private:
    std::int32_t next() {
        if (position_ >= stream_.size()) refuse("encoded task: too short");
        return stream_[position_++];
    }
    std::int32_t below(std::int64_t bound) {
        const std::int32_t value = next();
        if (value < 0 || value >= bound) refuse("encoded task: number out of range");
        return value;
    }
    std::int32_t count() { return below(std::int64_t{1} << 31); }
    // The length of a list whose elements take at least one number each.
    std::int32_t length() { return below(static_cast<std::int64_t>(stream_.size() - position_) + 1); }

    std::vector<Term> read_terms(std::int32_t number) {
        if (number > static_cast<std::int64_t>(stream_.size() - position_)) refuse("encoded task: too short");
        std::vector<Term> terms(number);
        for (auto& term : terms) {
            term = next();
            if (term >= scope_ || ~term >= task_.num_objects) refuse("encoded task: term out of range");
        }
        return terms;
    }
    std::vector<std::int32_t> read_variables() {
        std::vector<std::int32_t> domains(length());
        for (auto& domain : domains) domain = below(static_cast<std::int64_t>(task_.domains.size()));
        scope_ += static_cast<std::int32_t>(domains.size());
        task_.num_variables = std::max(task_.num_variables, scope_);
        return domains;
    }
    std::int32_t read_predicate() { return below(static_cast<std::int64_t>(task_.arity.size())); }

    Formula read_formula(bool negated, int depth) {
        if (depth > max_depth) refuse("encoded task: formula nested too deeply");
        using Kind = Formula::Kind;
        Formula formula;
        const std::int32_t code = below(7);
        switch (code) {
            case 0:  // atom
                formula.kind = Kind::literal;
                formula.negated = negated;
                formula.predicate = read_predicate();
                formula.terms = read_terms(task_.arity[formula.predicate]);
                break;
            case 1:  // equality
                formula.kind = Kind::equality;
                formula.negated = negated;
                formula.terms = read_terms(2);
                break;
            case 2:  // negation
                return read_formula(!negated, depth + 1);
            case 3:    // conjunction
            case 4: {  // disjunction
                formula.kind = (code == 3) != negated ? Kind::conjunction : Kind::disjunction;
                const std::int32_t number = length();
                for (std::int32_t i = 0; i < number; ++i) {
                    Formula part = read_formula(negated, depth + 1);
                    if (part.kind == formula.kind)
                        std::move(part.parts.begin(), part.parts.end(), std::back_inserter(formula.parts));
                    else
                        formula.parts.push_back(std::move(part));
                }
                break;
            }
            default: {  // exists, forall
                formula.kind = (code == 5) != negated ? Kind::exists : Kind::forall;
                const std::int32_t scope = scope_;
                formula.first_variable = scope;
                formula.domains = read_variables();
                formula.parts.push_back(read_formula(negated, depth + 1));
                scope_ = scope;
            }
        }
        return formula;
    }

    void read_schema(Schema& schema) {
        scope_ = 0;
        schema.domains = read_variables();
        schema.precondition = read_formula(false, 0);
        schema.effects.resize(length());
        const std::int32_t scope = scope_;
        for (auto& effect : schema.effects) {
            effect.first_variable = scope;
            effect.domains = read_variables();
            effect.condition = read_formula(false, 0);
            effect.positive = below(2) == 1;
            effect.predicate = read_predicate();
            effect.terms = read_terms(task_.arity[effect.predicate]);
            task_.fluent[effect.predicate] = 1;
            scope_ = scope;
        }
        schema.cost = count();
        schema.cost_terms.resize(length());
        for (auto& term : schema.cost_terms) {
            term.function = below(static_cast<std::int64_t>(task_.functions.size()));
            term.terms = read_terms(task_.functions[term.function].arity);
        }
    }

    std::span<const std::int32_t> stream_;
    LiftedTask& task_;
    std::size_t position_ = 0;
    std::int32_t scope_ = 0;
};

void check_objects(const LiftedTask& task, std::span<const std::int32_t> objects) {
    for (const std::int32_t object : objects)
        if (object < 0 || object >= task.num_objects) refuse("encoded task: object out of range");
}

}  // namespace

LiftedTask read_lifted_task(std::span<const std::int32_t> structure,
                            const std::vector<std::span<const std::int32_t>>& initial,
                            const std::vector<std::int32_t>& num_initial,
                            const std::vector<std::span<const std::int32_t>>& function_arguments,
                            const std::vector<std::span<const std::int32_t>>& function_values) {
    LiftedTask task;
    Reader(structure, task).read();
    if (initial.size() != task.arity.size() || num_initial.size() != task.arity.size())
        refuse("encoded task: one list of initial atoms a predicate");
    for (std::size_t p = 0; p < initial.size(); ++p) {
        if (num_initial[p] < 0 || initial[p].size() != std::size_t(num_initial[p]) * task.arity[p])
            refuse("encoded task: initial atoms of the wrong arity");
        check_objects(task, initial[p]);
    }
    task.initial = initial;
    task.num_initial = num_initial;
    if (function_arguments.size() != task.functions.size() || function_values.size() != task.functions.size())
        refuse("encoded task: one list of values a function");
    for (std::size_t f = 0; f < task.functions.size(); ++f) {
        auto& function = task.functions[f];
        function.arguments = function_arguments[f];
        function.values = function_values[f];
        if (function.arguments.size() != function.values.size() * function.arity)
            refuse("encoded task: function values of the wrong arity");
        check_objects(task, function.arguments);
        if (std::any_of(function.values.begin(), function.values.end(), [](auto value) { return value < 0; }))
            refuse("encoded task: negative cost");
    }
    return task;
}

}  // namespace explicable::grounding
