// What Pinocchio's own build writes, for its headers alone.
#pragma once
#define PINOCCHIO_STRING_OF(text) #text
#define PINOCCHIO_STRING(text) PINOCCHIO_STRING_OF(text)
