/* A reduced cycloidal drive as an FMI 2.0 co-simulation unit: torques by the angles of input and output.
 *
 * Tables are in reduced_drive_tables.h, which cyclo writes for each drive. The law is that of reduced_drive.py: wind-up with play
 * and orders of the transmission error, Maxwell-slip elements on the elastic torque, a bristle for the friction at the input.
 * Outputs are those of the inputs as they are set; fmi2DoStep takes them over into the state.
 */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "reduced_drive_tables.h"

/* Types of the FMI 2.0 standard (section 2.1), declared here so that nothing else is needed to compile. */
typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef int fmi2StatusKind;
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#if defined _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { INPUT_ANGLE, OUTPUT_ANGLE, INPUT_TORQUE, OUTPUT_TORQUE, WIND_UP, ELASTIC_TORQUE, TRANSMISSION_RATIO, VARIABLES };

typedef struct {
    double input_angle, output_angle;
    double elastic, bristle, bristle_at;
    double elements[ELEMENTS + 1];
} State;

typedef struct {
    double elastic, input_torque, output_torque;
    State after;
} Answer;

static double within(double value, double low, double high) {
    return value < low ? low : value > high ? high : value;
}

static double wind_up_of(const State *state) {
    return state->output_angle - state->input_angle / RATIO;
}

static double elastic_torque(const State *state) {
    double node[NODES], wound = wind_up_of(state), width;
    int k, j, first = 0;
    for (j = 0; j < NODES; j++) node[j] = MEAN[j];
    for (k = 0; k < ORDERS; k++) {
        double phase = ORDER[k] * CRANKS * state->input_angle, c = cos(phase), s = sin(phase);
        for (j = 0; j < NODES; j++) node[j] += COSINE[k][j] * c + SINE[k][j] * s;
    }
    for (j = 1; j < NODES; j++)
        if (node[j] < node[j - 1]) node[j] = node[j - 1];
    while (first < NODES - 2 && node[first + 1] < wound) first++;
    width = node[first + 1] - node[first];
    if (width <= 0.0) return TORQUE[first];
    return TORQUE[first] + (wound - node[first]) / width * (TORQUE[first + 1] - TORQUE[first]);
}

static double friction(const double *table, double torque) {
    int j = 0;
    if (torque <= FRICTION_TORQUE[0]) return table[0];
    if (torque >= FRICTION_TORQUE[FRICTIONS - 1]) return table[FRICTIONS - 1];
    while (FRICTION_TORQUE[j + 1] < torque) j++;
    return table[j] + (torque - FRICTION_TORQUE[j]) / (FRICTION_TORQUE[j + 1] - FRICTION_TORQUE[j]) * (table[j + 1] - table[j]);
}

static void answer(const State *state, Answer *found) {
    double torque, forward, backward, most, ccw = 1.0, cw = 1.0;
    int e;
    found->after = *state;
    torque = found->elastic = found->after.elastic = elastic_torque(state);
    for (e = 0; e < FACTORS; e++) {
        double phase = FACTOR_ORDER[e] * CRANKS * state->input_angle;
        double c = cos(phase), s = sin(phase);
        ccw += FACTOR_CCW[e][0] * c + FACTOR_CCW[e][1] * s;
        cw += FACTOR_CW[e][0] * c + FACTOR_CW[e][1] * s;
    }
    if (ccw < 0.0) ccw = 0.0;
    if (cw < 0.0) cw = 0.0;
    for (e = 0; e < ELEMENTS; e++) {
        double weight = 1.0 + WEIGHT_AMPLITUDE[e] * cos(WEIGHT_ORDER[e] * CRANKS * state->input_angle - WEIGHT_PHASE[e]);
        double load = fmax(FLANK[e] * found->elastic, 0.0), before = fmax(FLANK[e] * state->elastic, 0.0);
        weight *= FLANK[e] > 0.0 ? ccw : cw;
        most = weight * STRENGTH[e] * RATED * pow(load / RATED, EXPONENT[e]);
        found->after.elements[e] = within(state->elements[e] + weight * STIFFNESS[e] * (load - before), -most, most);
        torque += FLANK[e] * found->after.elements[e];
    }
    forward = friction(FRICTION_CCW, found->elastic);
    backward = friction(FRICTION_CW, found->elastic);
    most = forward > backward ? forward : backward;
    found->after.bristle =
        within(state->bristle + most * (state->input_angle - state->bristle_at) / BRISTLE_ANGLE, -backward, forward);
    found->after.bristle_at = state->input_angle;
    found->input_torque = torque / RATIO - found->after.bristle;
    found->output_torque = -torque;
}

static void restart(State *state) {
    memset(state, 0, sizeof *state);
}

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[]) {
    (void)c, (void)on, (void)n, (void)names;
    return fmi2OK;
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                     const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    State *state;
    (void)name, (void)resources, (void)functions, (void)visible, (void)logging;
    if (type != fmi2CoSimulation || guid == NULL || strcmp(guid, GUID) != 0) return NULL;
    state = malloc(sizeof *state);
    if (state != NULL) restart(state);
    return state;
}

EXPORT void fmi2FreeInstance(fmi2Component c) { free(c); }

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean t, fmi2Real tol, fmi2Real start, fmi2Boolean s, fmi2Real stop) {
    (void)c, (void)t, (void)tol, (void)start, (void)s, (void)stop;
    return fmi2OK;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    State *state = c;
    state->bristle_at = state->input_angle; /* friction begins where the input stands */
    return fmi2OK;
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c) {
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Reset(fmi2Component c) {
    restart(c);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    const State *state = c;
    Answer found;
    size_t i;
    answer(state, &found);
    for (i = 0; i < n; i++) switch (vr[i]) {
        case INPUT_ANGLE: value[i] = state->input_angle; break;
        case OUTPUT_ANGLE: value[i] = state->output_angle; break;
        case INPUT_TORQUE: value[i] = found.input_torque; break;
        case OUTPUT_TORQUE: value[i] = found.output_torque; break;
        case WIND_UP: value[i] = wind_up_of(state); break;
        case ELASTIC_TORQUE: value[i] = found.elastic; break;
        case TRANSMISSION_RATIO: value[i] = RATIO; break;
        default: return fmi2Error;
        }
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    State *state = c;
    size_t i;
    for (i = 0; i < n; i++) {
        if (vr[i] == INPUT_ANGLE) state->input_angle = value[i];
        else if (vr[i] == OUTPUT_ANGLE) state->output_angle = value[i];
        else return fmi2Error;
    }
    return fmi2OK;
}

#define NOTHING_OF(NAME, TYPE)                                                                              \
    EXPORT fmi2Status NAME(fmi2Component c, const fmi2ValueReference vr[], size_t n, TYPE value[]) {        \
        (void)c, (void)vr, (void)value;                                                                     \
        return n == 0 ? fmi2OK : fmi2Error;                                                                 \
    }
NOTHING_OF(fmi2GetInteger, fmi2Integer)
NOTHING_OF(fmi2GetBoolean, fmi2Boolean)
NOTHING_OF(fmi2GetString, fmi2String)
NOTHING_OF(fmi2SetInteger, const fmi2Integer)
NOTHING_OF(fmi2SetBoolean, const fmi2Boolean)
NOTHING_OF(fmi2SetString, const fmi2String)

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *kept) {
    if (*kept == NULL) *kept = malloc(sizeof(State));
    if (*kept == NULL) return fmi2Error;
    memcpy(*kept, c, sizeof(State));
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate kept) {
    memcpy(c, kept, sizeof(State));
    return fmi2OK;
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *kept) {
    (void)c;
    free(*kept);
    *kept = NULL;
    return fmi2OK;
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate kept, size_t *size) {
    (void)c, (void)kept;
    *size = sizeof(State);
    return fmi2OK;
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate kept, fmi2Byte bytes[], size_t size) {
    (void)c;
    if (size < sizeof(State)) return fmi2Error;
    memcpy(bytes, kept, sizeof(State));
    return fmi2OK;
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *kept) {
    (void)c;
    if (size < sizeof(State)) return fmi2Error;
    if (*kept == NULL) *kept = malloc(sizeof(State));
    if (*kept == NULL) return fmi2Error;
    memcpy(*kept, bytes, sizeof(State));
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference u[], size_t nu, const fmi2ValueReference k[],
                                               size_t nk, const fmi2Real dk[], fmi2Real du[]) {
    (void)c, (void)u, (void)nu, (void)k, (void)nk, (void)dk, (void)du;
    return fmi2Error; /* the model description says that there are none */
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
                                              const fmi2Real value[]) {
    (void)c, (void)vr, (void)order, (void)value;
    return n == 0 ? fmi2OK : fmi2Error;
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
                                               fmi2Real value[]) {
    (void)c, (void)vr, (void)order, (void)value;
    return n == 0 ? fmi2OK : fmi2Error;
}

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean kept) {
    State *state = c;
    Answer found;
    (void)time, (void)step, (void)kept;
    answer(state, &found);
    *state = found.after;
    return isfinite(found.elastic) ? fmi2OK : fmi2Error;
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c) {
    (void)c;
    return fmi2Error;
}

#define NO_STATUS(NAME, TYPE)                                                      \
    EXPORT fmi2Status NAME(fmi2Component c, const fmi2StatusKind kind, TYPE *value) { \
        (void)c, (void)kind, (void)value;                                          \
        return fmi2Discard;                                                        \
    }
NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetRealStatus, fmi2Real)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetBooleanStatus, fmi2Boolean)
NO_STATUS(fmi2GetStringStatus, fmi2String)
