#pragma once
#include <stdint.h>

#define LOG_UINT8 1
#define LOG_UINT32 3
#define LOG_FLOAT 7
struct log_s { uint8_t type; const char *name; void *address; };
#define LOG_GROUP_START(NAME) static const struct log_s __logs_##NAME[] __attribute__((used)) = { { 0x80, #NAME, 0 },
#define LOG_ADD(TYPE, NAME, ADDRESS) { TYPE, #NAME, (void *)(ADDRESS) },
#define LOG_GROUP_STOP(NAME) };
