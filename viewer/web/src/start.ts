// The start page: what is open, and examples to begin with.
import {make} from './dom';

export interface Card {
  name: string;
  described: string;
  open: () => void;
}
export interface Section {
  title: string;
  words: string;
  cards: Card[];
}

export function startPage(sections: Section[]): HTMLElement {
  const card = ({name, described, open}: Card) => make('button', {type: 'button', class: 'card', click: open}, make('strong', {}, name), make('span', {}, described));
  return make('div', {class: 'start'},
    ...sections.map(({title, words, cards}) => make('section', {}, make('h2', {}, title), make('p', {}, words), make('div', {class: 'cards'}, ...cards.map(card)))),
    make('p', {class: 'hint'}, 'Files are named on the command line: retalho view FILE… Nothing leaves this machine.'));
}
