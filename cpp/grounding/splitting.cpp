#include "grounding/splitting.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace explicable::grounding {
namespace {

constexpr std::size_t max_variants = 64;

using Kind = Formula::Kind;

void rename(Formula& formula, std::int32_t from, std::int32_t to) {
    std::replace(formula.terms.begin(), formula.terms.end(), from, to);
    for (Formula& part : formula.parts) rename(part, from, to);
}

bool mentions(const Formula& formula, std::int32_t variable) {
    return std::find(formula.terms.begin(), formula.terms.end(), variable) != formula.terms.end() ||
           std::any_of(formula.parts.begin(), formula.parts.end(),
                       [&](const Formula& part) { return mentions(part, variable); });
}

class Splitter {
public:
    explicit Splitter(std::int32_t& num_variables) : num_variables_(num_variables) {}

    std::vector<Variant> split(const Schema& schema) {
        std::vector<Formula> conjuncts = schema.precondition.kind == Kind::conjunction
                                             ? schema.precondition.parts
                                             : std::vector<Formula>{schema.precondition};
        std::vector<std::uint8_t> bound(schema.domains.size(), 0);
        for (const Formula& part : conjuncts)
            if (part.kind == Kind::literal && !part.negated)
                for (const Term term : part.terms)
                    if (term >= 0) bound[term] = 1;
        std::vector<Variant> variants(1);
        for (const Formula& part : conjuncts) {
            bool binds = false;
            for (std::size_t v = 0; v < bound.size(); ++v)
                binds = binds || (!bound[v] && mentions(part, static_cast<std::int32_t>(v)));
            multiply(variants, binds ? expand(part) : whole(part));
        }
        return variants;
    }

private:
    static std::vector<Variant> whole(const Formula& formula) {
        std::vector<Variant> variants(1);
        variants[0].conjuncts.push_back(formula);
        return variants;
    }
    static void multiply(std::vector<Variant>& left, const std::vector<Variant>& right) {
        std::vector<Variant> product;
        for (const Variant& a : left)
            for (const Variant& b : right) {
                Variant& both = product.emplace_back(a);
                both.variables.insert(both.variables.end(), b.variables.begin(), b.variables.end());
                both.domains.insert(both.domains.end(), b.domains.begin(), b.domains.end());
                both.conjuncts.insert(both.conjuncts.end(), b.conjuncts.begin(), b.conjuncts.end());
            }
        left = std::move(product);
    }

    // The variants that a formula is the disjunction of; the formula itself where they would be too many.
    std::vector<Variant> expand(const Formula& formula) {
        std::vector<Variant> variants;
        switch (formula.kind) {
            case Kind::conjunction:
                variants.resize(1);
                for (const Formula& part : formula.parts) {
                    const std::vector<Variant> factor = expand(part);
                    multiply(variants, variants.size() * factor.size() > max_variants ? whole(part) : factor);
                }
                return variants;
            case Kind::disjunction:
                for (const Formula& part : formula.parts)
                    std::ranges::move(expand(part), std::back_inserter(variants));
                return variants.size() > max_variants ? whole(formula) : variants;
            case Kind::exists: {
                Formula body = formula.parts[0];
                std::vector<std::int32_t> fresh;
                for (std::size_t i = 0; i < formula.domains.size(); ++i) {
                    rename(body, formula.first_variable + static_cast<std::int32_t>(i), num_variables_);
                    fresh.push_back(num_variables_++);
                }
                variants = expand(body);
                for (Variant& variant : variants) {
                    variant.variables.insert(variant.variables.end(), fresh.begin(), fresh.end());
                    variant.domains.insert(variant.domains.end(), formula.domains.begin(), formula.domains.end());
                }
                return variants;
            }
            default:
                return whole(formula);
        }
    }

    std::int32_t& num_variables_;
};

}  // namespace

std::vector<Variant> split_precondition(const Schema& schema, std::int32_t& num_variables) {
    return Splitter(num_variables).split(schema);
}

}  // namespace explicable::grounding
