// SPDX-License-Identifier: Apache-2.0
// Linked into test programs of sanitizer builds only: makes libraries behave so that reports can be read.

/// Libraries stay loaded: what a plugin or driver leaks is told by its name, and rules in leaks.supp can match it.
extern "C" int dlclose(void*) { return 0; }
