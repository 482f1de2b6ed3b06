/* {{ p.joint }}: the torque at its winch, foretold sample by sample.
 * Written by tautline {{ p.version }} from {{ p.source }}. C99, <math.h> alone; no allocation, bounded time.
 *
 *     {{ p.name }}_state s;
 *     {{ p.name }}_start(&s, position_rad, 1, 0.0);       once, the joint having moved up last
 *     y_nm = {{ p.name }}_torque_nm(&s, &sample);         once a sample{% if p.late.is_some() %}, {{ p.rate_hz }} times a second{% endif %}
 *
 * The first values are right once the joint has moved through its clearance: before, nobody knows where friction stands.
{%- if p.prismatic %}
 * The joint slides: _rad is m, _nm is N.
{%- endif %}
{%- for effect in p.effects %}
 * {{ effect }}
{%- endfor %}
 */
#ifndef {{ p.upper }}_MODEL_H
#define {{ p.upper }}_MODEL_H

#include <math.h>

/* One joint's motion. */
typedef struct {
    double position_rad;
    double velocity_rad_s;
    double acceleration_rad_s2;
} {{ p.name }}_motion;

/* What the joint does now. */
typedef struct {
    double measured_rad;        /* position as measured: friction's state follows it */
    {{ p.name }}_motion own;         /* smoothed; its position may be the measured one */
{%- if let Some(chain) = p.chain %}
    double load_nm;             /* M a + C v + G of {{ chain }}, and any measured load, at the joint */
{%- else %}
    double load_nm;             /* a measured load at the joint beside gravity and inertia; 0 without */
{%- endif %}
{%- if p.needs_slope %}
    double slope_nm_rad;        /* how gravity changes with the joint's position */
{%- endif %}
    double time_s;              /* since the recording began */
    double elapsed_s;           /* since the joint was switched on, cold */
{%- if p.others > 0 %}
    {{ p.name }}_motion others[{{ p.others }}];
{%- endif %}
} {{ p.name }}_sample;

/* What is remembered from sample to sample. */
typedef struct {
    double k_f;                 /* -1 on the branch down, 1 on the branch up */
    double k_tilde;             /* 0 down, 1 up */
    double direction;           /* of the motion followed last: 1 up, -1 down */
    double start_k_f, start_k_tilde, at_rad;
    double deadband_rad;        /* travel back of less is no reversal: the encoder's noise */
{%- if p.passage.left.is_some() %}
    double bent, bent_at_rad;   /* where friction stands elastically, and since where */
{%- endif %}
{%- if let Some(late) = p.late %}
    double late_nm[{{ late.kept }}];
    unsigned newest, filled;
{%- endif %}
{%- if p.follows.is_some() %}
    double given_nm, reading_nm; /* what the sensor was given last, and made of it */
    int follows;
{%- endif %}
} {{ p.name }}_state;

/* The joint is at measured_rad and has moved up (or down) for long. */
static inline void {{ p.name }}_start({{ p.name }}_state *s, double measured_rad, int up, double deadband_rad)
{
    s->direction = up ? 1.0 : -1.0;
    s->k_f = s->direction;
    s->k_tilde = up ? 1.0 : 0.0;
    s->start_k_f = s->k_f;
    s->start_k_tilde = s->k_tilde;
    s->at_rad = measured_rad;
    s->deadband_rad = deadband_rad;
{%- if p.passage.left.is_some() %}
    s->bent = s->k_tilde;
    s->bent_at_rad = measured_rad;
{%- endif %}
{%- if p.late.is_some() %}
    s->newest = 0;
    s->filled = 0;
{%- endif %}
{%- if p.follows.is_some() %}
    s->follows = 0;
{%- endif %}
}

/* Where friction stands between its branches once the joint is at x: 0 down, 1 up. */
static inline double {{ p.name }}_passage({{ p.name }}_state *s, double x, double v)
{
    const double travel = x - s->at_rad, onward = travel * s->direction;
    const int turned = onward < -s->deadband_rad;
    if (turned) {
        s->direction = travel > 0.0 ? 1.0 : -1.0;
        s->start_k_f = s->k_f;
        s->start_k_tilde = s->k_tilde;
    }
    if (turned || onward > 0.0) {
        const double end = s->direction;
        s->at_rad = x;
        s->k_f = {{ p.passage.moved }};
        const double whole = end - s->start_k_f;
        const double u = whole == 0.0 ? 1.0 : (s->k_f - s->start_k_f) / whole;
        (void)u;
        s->k_tilde = {{ p.passage.k_tilde }};
    }
    (void)v;
{%- if let Some(left) = p.passage.left %}
    const double moved = fabs(x - s->bent_at_rad);
    if (moved >= 0.0) {
        const double target = {% if p.jumps.is_some() %}(s->direction + 1.0) / 2.0{% else %}s->k_tilde{% endif %};
        const double behind = s->bent - target;
        const double left = {{ left }};
        s->bent_at_rad = x;
        s->bent = target + copysign(left, behind);
    }
    return s->bent;
{%- else if let Some(at_rest) = p.jumps %}
    return fabs(v) < {{ at_rest }} ? (s->direction + 1.0) / 2.0 : v > 0.0 ? 1.0 : 0.0;
{%- else %}
    return s->k_tilde;
{%- endif %}
}
{%- if let Some(late) = p.late %}

/* y as it was {{ late.whole }} samples and a share of {{ late.share }} before; the first one until there are so many. */
static inline double {{ p.name }}_late_nm({{ p.name }}_state *s, double y)
{
    const unsigned kept = {{ late.kept }}u;
    s->newest = (s->newest + 1u) % kept;
    s->late_nm[s->newest] = y;
    if (s->filled < kept) {
        s->filled += 1u;
    }
    if (s->filled < kept) {
        return s->late_nm[(s->newest + kept + 1u - s->filled) % kept];
    }
    const double after = s->late_nm[(s->newest + kept - {{ late.whole }}u) % kept];
    const double before = s->late_nm[(s->newest + kept - {{ late.whole }}u - 1u) % kept];
    return after + {{ late.share }} * (before - after);
}
{%- endif %}

{%- if let Some(follows) = p.follows %}
/* What a sensor that follows with a lag makes of y. */
static inline double {{ p.name }}_following_nm({{ p.name }}_state *s, double y)
{
    if (!s->follows || !(fabs(s->reading_nm) >= 0.0)) {
        s->follows = 1;
        s->reading_nm = y;
    } else {
        s->reading_nm = {{ follows.reading }} * s->reading_nm + {{ follows.now }} * y + {{ follows.before }} * s->given_nm;
    }
    s->given_nm = y;
    return s->reading_nm;
}

{% endif %}
/* What the torque sensor at the winch will read, N m. */
static inline double {{ p.name }}_torque_nm({{ p.name }}_state *s, const {{ p.name }}_sample *x)
{
    const double q = x->own.position_rad, v = x->own.velocity_rad_s, a = x->own.acceleration_rad_s2;
    const double t = x->time_s, elapsed = x->elapsed_s;
    const double k = {{ p.name }}_passage(s, x->measured_rad, v);
    (void)q, (void)a, (void)t, (void)elapsed, (void)k;
{{ p.body }}    return y;
}

#endif
