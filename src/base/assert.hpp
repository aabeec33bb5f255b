// SPDX-License-Identifier: Apache-2.0
// Broken invariants are bugs: they stop the program with file and line, in every build type.
#pragma once

#include <cstdio>
#include <cstdlib>

#define RELUMINE_ASSERT(condition)                                                                 \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            std::fprintf(stderr, "%s:%d: broken invariant: %s\n", __FILE__, __LINE__, #condition); \
            std::abort();                                                                          \
        }                                                                                          \
    } while (false)
