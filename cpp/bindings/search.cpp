#include "bindings/bindings.hpp"

void bind_search(nb::module_&) {}
