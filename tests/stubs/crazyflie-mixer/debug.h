/* What the mixer says is of no account. */
#pragma once
#define DEBUG_PRINT(...) ((void)0)
