#include "bindings/bindings.hpp"

void bind_labelling(nb::module_&) {}
