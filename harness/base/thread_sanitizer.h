// TOUCHSTONE_THREAD_SANITIZER is defined where the thread sanitizer is built in.
#pragma once

#if defined(__SANITIZE_THREAD__)  // gcc; first, since libraries define __has_feature to be 0 for it
#define TOUCHSTONE_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define TOUCHSTONE_THREAD_SANITIZER
#endif
#endif
