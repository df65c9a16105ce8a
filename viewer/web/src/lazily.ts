// Views are made when they are first shown: each in space has a graphics context of its own, and what is not looked at
// costs nothing.
import {make} from './dom';

export interface Lazy<View> {
  /** The view; null where this browser gives no WebGL 2, which is then said in its place. */
  get(): View | null;
  /** The view if it has been made. */
  readonly made: View | null;
  /** Says, where the view would be, that there is none. */
  readonly failure: HTMLElement;
}

export function lazily<View>(build: () => View, add: (view: View) => void): Lazy<View> {
  const failure = make('div', {class: 'failure', role: 'alert', hidden: true}, make('p', {}, 'This browser gives no WebGL 2 here, which this view needs: another browser, or its hardware acceleration, may help. Curves are drawn without it.'));
  let made: View | null = null, failed = false;
  return {
    failure,
    get made() { return made; },
    get() {
      if (made || failed) return made;
      try {
        made = build();
        add(made);
      } catch (error) {
        console.warn(error);
        failed = true;
      }
      return made;
    },
  };
}
