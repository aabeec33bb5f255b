# SPDX-License-Identifier: Apache-2.0
# Warnings, floating-point rules and sanitizers, as one INTERFACE target that our own targets link.
add_library(relumine_flags INTERFACE)

target_compile_options(relumine_flags INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wshadow
    -ffp-contract=off  # the same bits whether or not the machine has fused multiply-add
    -fno-math-errno)   # square roots become instructions; changes no value
if(RELUMINE_WERROR)
    target_compile_options(relumine_flags INTERFACE -Werror)
endif()

if(RELUMINE_SANITIZE)
    target_compile_options(relumine_flags INTERFACE -fsanitize=${RELUMINE_SANITIZE} -fno-omit-frame-pointer
                           -fno-sanitize-recover=undefined)
    target_link_options(relumine_flags INTERFACE -fsanitize=${RELUMINE_SANITIZE})
endif()
