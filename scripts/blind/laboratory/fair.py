"""Whether a case is a fair question, and what cannot be told from its truth."""
import dataclasses

from absorb import best, bursts, fit
from draw import Unfit
from rivals import slow_waves, textbook

OWN_LEFT = 0.6  # of the gap: the most that the textbook form of the truth leaves
CLOSE = 0.25  # floors: what leaves no more than this beyond the truth's textbook form cannot be told from it
BETTER = 0.5  # floors: no rival leaves less by more than this
NEEDED = 0.4  # floors: what each of several causes must take away
OUTSIDE_LEFT = 0.6  # of a gap from outside the library: what the best textbook form leaves, at least
OUTSIDE_FLOORS = 0.8
PUSHES = 8  # that a contact may have as a rival
TURNS = ("reversal_transition", "presliding")


@dataclasses.dataclass
class Finding:
    """What textbook forms leave of the gap."""

    own: float | None = None  # floors that the textbook form of the truth leaves
    left: dict = dataclasses.field(default_factory=dict)  # floors that each rival leaves
    indistinguishable: list = dataclasses.field(default_factory=list)


def judge(kind, causes, effects, absorber, gap, whole, span):
    """Raises Unfit where the question is not fair. `whole`: floors of the gap that the base cannot absorb."""
    if kind == "none":
        return Finding()
    forms = textbook(absorber, "sensor_drift" in causes)
    if kind == "unknown":
        return outside(absorber, gap, forms, whole, span)
    pushes = PUSHES
    for effect in effects:
        if effect.bursts:
            pushes = int(1.6 * effect.bursts) + 3
    if len(causes) == 1:
        return single(causes[0], absorber, gap, forms, whole, pushes)
    return several(causes, absorber, gap, forms, whole, pushes)


def outside(absorber, gap, forms, whole, span):
    """A thing from outside the library must be more than any cause of the library."""
    left = {"contact": fit(absorber, gap, forms, ["contact"], PUSHES)[0]}
    left |= {cause: best(absorber, gap, f)[0] for cause, f in forms.items()}
    for cause, waves in slow_waves(absorber, span).items():
        left[cause] = min(left[cause], best(absorber, gap, waves)[0])
    nearest = min(left, key=left.get)
    if left[nearest] < OUTSIDE_LEFT * whole or left[nearest] < OUTSIDE_FLOORS:
        raise Unfit(f"{nearest} would explain it")
    return Finding(left=left)


def single(cause, absorber, gap, forms, whole, pushes):
    """One cause must explain its gap itself, and no other one better."""
    own = fit(absorber, gap, forms, [cause], pushes)[0]
    if own > OWN_LEFT * whole:
        raise Unfit("textbook of the truth explains little")
    found = Finding(own, {cause: own})
    for rival in [*forms, "contact"]:
        if rival == cause:
            continue
        left = fit(absorber, gap, forms, [rival], PUSHES)[0]
        found.left[rival] = left
        if left <= own + CLOSE:
            if rival == "backlash_width" and cause in TURNS:
                raise Unfit("no more than another width of the zone")
            found.indistinguishable.append(rival)
        if left < own - BETTER:
            raise Unfit(f"{rival} explains {cause} better")
    return found


def several(causes, absorber, gap, forms, whole, pushes):
    """Of several causes each must be needed; none may do for all, none from elsewhere do better."""
    own, chosen = fit(absorber, gap, forms, causes, pushes)
    if own > OWN_LEFT * whole:
        raise Unfit("textbook of the truth explains little")
    found, better = Finding(own), False
    rivals = [r for r in [*forms, "contact"] if r not in causes]
    for cause in causes:
        others = [k for k in causes if k != cause]
        left, without = fit(absorber, gap, forms, others, pushes)
        if left < own + NEEDED:
            raise Unfit(f"{cause} not needed")
        settings = [[c for k in others for c in columns[k]] for columns in (without, chosen)]
        for rival in rivals:
            if rival in found.indistinguishable:
                continue
            if rival == "contact":
                left = min(absorber.left(gap, s + bursts(absorber, gap, s, PUSHES)) for s in settings)
            else:
                left = min(best(absorber, gap, forms[rival], s)[0] for s in settings)
            if left <= own + CLOSE:
                found.indistinguishable.append(rival)
            better = better or left < own - CLOSE
    if better:
        raise Unfit("a rival explains it better")
    for rival in [*forms, "contact"]:
        found.left[rival] = fit(absorber, gap, forms, [rival], PUSHES)[0]
        if found.left[rival] <= own + CLOSE:
            raise Unfit(f"{rival} alone explains it")
    return found
