// SPDX-License-Identifier: AGPL-3.0-or-later
// Functions for this process: its limits and priority, and the time and memory that it has used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <system_error>

namespace limber {

std::int64_t process_id();

// Makes the system kill this process when the thread in the process `parent` that started it ends. Returns false if
// `parent` has already ended.
bool end_with_parent(std::int64_t parent);
// Closes all open files except the standard streams.
void close_inherited_files();

// Gives this process the lowest priority, so that all other programs run first.
void yield_to_other_programs();
// Lowers the priority of the calling thread: it gets a tenth of the time of a normal thread on the same core. A refusal
// by the system is ignored.
void lower_priority_of_thread();
// Limits the address space of this process. Returns the system's error, if any.
std::error_code limit_memory(std::int64_t bytes);

double own_cpu_seconds();       // CPU time of all threads of this process, seconds
double thread_cpu_seconds();    // CPU time of the calling thread, seconds
double children_cpu_seconds();  // CPU time of the child processes that have ended, seconds
std::int64_t peak_memory();     // largest memory that this process has used so far, bytes
std::size_t mapped_memory();    // size of the address space, bytes

}  // namespace limber
