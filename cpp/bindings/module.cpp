// The extension module explicable._core: one submodule-free namespace, one bind_ function per folder of cpp/.
#include "bindings/bindings.hpp"

NB_MODULE(_core, module) {
    module.doc() = "Compiled core of explicable: grounding, search and sequence labelling.";
#ifndef EXPLICABLE_SANITIZE
    // A thread that still holds a task when Python ends, as a server's or a robot's may, never lets go of it:
    // that is no leak, and nobody who uses a program wants to read of it. Sanitized builds still tell.
    nb::set_leak_warnings(false);
#endif
    bind_task(module);
    bind_search(module);
    bind_labelling(module);
    bind_scorer(module);
}
